#!/bin/sh
# Makes ../static/codemirror.js, the editor of the site's pages, from the npm packages that package.json pins.
# Run it after a change of entry.js or package.json; the same versions give the same bytes.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
cp "$here/package.json" "$here/entry.js" "$place"
cd "$place"
npm install --silent --no-package-lock --no-audit --no-fund

# A page's policy forbids <style>. style-mod uses a constructed style sheet only in shadow roots: let it always do so.
file=node_modules/style-mod/src/style-mod.js
grep -q '!root\.head && root\.adoptedStyleSheets' "$file"
sed -i 's/!root\.head && root\.adoptedStyleSheets/root.adoptedStyleSheets/' "$file"

licence() {
    echo "/*! CodeMirror, Lezer and what they use, in one file (MIT License), by ../codemirror/bundle.sh. style-mod is changed:"
    echo "it always uses constructed style sheets."
    echo
    find node_modules -name LICENSE ! -path '*esbuild*' -exec grep -h '^Copyright' {} + | sort -u
    sed '1,/^Copyright/d' node_modules/@codemirror/view/LICENSE
    echo "*/"
}
node_modules/.bin/esbuild entry.js --bundle --minify --format=esm --target=es2022 --legal-comments=none \
    "--banner:js=$(licence)" --outfile="$here/../static/codemirror.js" --log-level=warning
