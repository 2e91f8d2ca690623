#!/bin/sh
# build_package.sh CPACK BUILD_FOLDER: packs what is built into BUILD_FOLDER/package.
set -eu
cpack=$1 build=$2

command -v dpkg-shlibdeps >/dev/null || { echo "skipped: dpkg-shlibdeps is not installed (package dpkg-dev)"; exit 77; }
cd "$build"
rm -rf package
"$cpack" -G DEB -B package
