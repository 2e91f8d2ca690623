#!/bin/sh
# user_test.sh FOLDER: systemd makes the service's user, with its groups, out of the file we ship.
set -eu
files=$1

command -v systemd-sysusers >/dev/null || { echo "skipped: systemd-sysusers is not installed (package systemd)"; exit 77; }
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
mkdir "$root/etc"
systemd-sysusers --root="$root" "$files/depthscope.sysusers"
grep -q '^depthscope:.*:/var/lib/depthscope:/usr/sbin/nologin$' "$root/etc/passwd" || { cat "$root/etc/passwd"; exit 1; }
for group in video render input; do
  grep -q "^$group:.*:depthscope$" "$root/etc/group" || { echo "FAILED: not in group $group"; cat "$root/etc/group"; exit 1; }
done
