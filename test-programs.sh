#!/bin/sh
# Installs the programs that only the tests use and that are no Python packages: Chromium, which opens the pages that
# Spinbook makes, and bubblewrap, the strongest of the sandbox's levels. `make test` calls this first; where both are
# there it does nothing. Where they can't be installed from here it says so, and the tests run all the same.
set -eu

say() { printf '%s\n' "$@" >&2; }

any_of() { for name in "$@"; do command -v "$name" >/dev/null 2>&1 && return; done; return 1; }

missing() {
    any_of chromium chromium-browser google-chrome google-chrome-stable || printf 'chromium '
    any_of bwrap || printf 'bubblewrap '
}

packages=$(missing)
if [ -z "$packages" ]; then exit 0; fi
packages=${packages% }

if [ "$(id -u)" = 0 ]; then as_root=""; else as_root="sudo -n"; fi

apt() { DEBIAN_FRONTEND=noninteractive $as_root apt-get -qq -o DPkg::Lock::Timeout=300 "$@" 2>&1; }

# The list of packages of a new machine is empty or old, so it is fetched first.
install() { apt update && apt install -y --no-install-recommends $packages; }

if any_of apt-get && { [ -z "$as_root" ] || sudo -n true 2>/dev/null; }; then
    say "Installing what the tests need, as system packages: $packages ..."
    if said=$(install) && [ -z "$(missing)" ]; then exit 0; fi
    say "" "$(printf '%s\n' "$said" | tail -n 5 | cut -c 1-300)"
fi
say "" "Missing for the tests, and not to be installed from here: $packages
    sudo apt-get install $packages
Without Chromium the tests of pages fail; without bubblewrap those of its sandbox are skipped." ""
