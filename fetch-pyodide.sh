#!/bin/sh
# Fetches Pyodide, CPython for web pages, into $VENV/share/spinbook/pyodide: pages of the site run nodes with it.
# `make setup` calls this. Where it can't be fetched, everything else works, and the site's pages have no Run buttons.
#
# It is the npm package `pyodide`, pinned by the digest that the registry publishes (Mozilla Public License 2.0).
set -eu
cd "$(dirname "$0")"
VERSION=314.0.7
SHA512=0YvXxEhfEdpLfb/XkM2BFAeMROq0iMUX2bzzH9pOttyMcWkwq+HbE5uyuGD82LN7y2q+SNvi/6V5JEsOlD2R1A==
FOLDER=${VENV:-.venv}/share/spinbook/pyodide

say() { printf '%s\n' "$@" >&2; }

if [ "$(cat "$FOLDER/.version" 2>/dev/null)" = "$VERSION $SHA512" ]; then exit 0; fi
command -v npm >/dev/null 2>&1 || {
    say "There is no npm here, so pages of the site get no Run buttons (sudo apt-get install npm, then make setup)."
    exit 0
}
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
if ! (cd "$place" && npm pack --silent "pyodide@$VERSION") >/dev/null 2>&1; then
    say "Pyodide could not be fetched from npm, so pages of the site get no Run buttons. Run make setup to try again."
    exit 0
fi
file=$place/pyodide-$VERSION.tgz
found=$(openssl dgst -sha512 -binary "$file" | openssl base64 -A)
if [ "$found" != "$SHA512" ]; then
    say "Pyodide's package is not the one that was pinned, so it is not used. Its digest: sha512-$found"
    exit 1
fi
rm -rf "$FOLDER"
mkdir -p "$FOLDER"
tar -xzf "$file" --strip-components=1 -C "$FOLDER"
printf '%s\n' "$VERSION $SHA512" >"$FOLDER/.version"
