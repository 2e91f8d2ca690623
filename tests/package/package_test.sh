#!/bin/sh
# package_test.sh FOLDER: the package in FOLDER holds what it should and pleases lintian where that is installed.
set -eu
deb=$(ls "$1"/depthscope_*.deb)
failed=0
fail() { echo "FAILED: $*"; failed=1; }

contents=$(dpkg-deb --contents "$deb" | awk '$1 !~ /^d/ {print $1, $2, $6}')
for file in usr/bin/depthscope usr/bin/depthscoped usr/bin/depthscope-ar etc/depthscope/depthscope.toml \
  usr/lib/systemd/system/depthscope.service usr/lib/sysusers.d/depthscope.conf usr/lib/tmpfiles.d/depthscope.conf \
  usr/lib/modules-load.d/depthscope.conf usr/lib/udev/rules.d/60-depthscope.rules \
  usr/share/man/man1/depthscope.1.gz usr/share/man/man8/depthscoped.8.gz usr/share/man/man8/depthscope-ar.8.gz \
  usr/share/doc/depthscope/copyright usr/share/doc/depthscope/changelog.gz; do
  echo "$contents" | grep -q " ./$file$" || fail "$file is missing"
done
strangers=$(echo "$contents" | grep -v ' \./\(etc/depthscope\|usr/bin\|usr/lib\|usr/share\)/' || true)
[ -z "$strangers" ] || fail "files in unexpected places: $strangers"
owners=$(echo "$contents" | awk '{print $2}' | sort -u)
[ "$owners" = root/root ] || fail "files not owned by root: $owners"

[ "$(dpkg-deb --info "$deb" conffiles)" = /etc/depthscope/depthscope.toml ] || fail "the configuration is no conffile"
for script in postinst prerm postrm; do
  dpkg-deb --info "$deb" $script | sh -n || fail "$script is not a shell script"
done
depends=$(dpkg-deb --field "$deb" Depends)
for needed in libc6 libsystemd0 libgles2 systemd udev libgl1-mesa-dri; do
  echo "$depends" | grep -q "\b$needed\b" || fail "$needed is not among the dependencies: $depends"
done

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
dpkg-deb --extract "$deb" "$folder"
"$folder/usr/bin/depthscoped" --version >/dev/null || fail "depthscoped does not run"
grep -q "^ExecStart=/usr/bin/depthscoped --config /etc/depthscope/depthscope.toml$" \
  "$folder/usr/lib/systemd/system/depthscope.service" || fail "the service starts another program than the one packaged"

if command -v lintian >/dev/null; then
  lintian --allow-root --fail-on error,warning "$deb" || fail "lintian complains"
else
  echo "lintian is not installed: its checks were left out"
fi
exit $failed
