#!/bin/sh
# Makes the notebooks of the checkout in /course and opens them in JupyterLab, on port 8888 of the container.
# The address to open, with its token, is in what it prints.
set -eu
cd "$(dirname "$0")/.."
spinbook build || echo "Not every chapter could be built: see above." >&2
exec jupyter lab --ip=0.0.0.0 --no-browser --ServerApp.root_dir="$PWD/build/notebooks" "$@"
