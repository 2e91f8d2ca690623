#!/bin/bash
# build_image.sh FOLDER PACKAGE...: makes the guest that the tests boot, in FOLDER: `vmlinux`, `initrd`, `root.ext4`,
# a Debian 12 with systemd, the PACKAGEs, the kernel's virtual hardware and an agent that runs commands. As root.
# Exit status 77: the packages cannot be had.
set -euo pipefail
recipe=$(dirname "$(readlink -f "$0")")
folder=$1
shift
mkdir -p "$folder"
work=$(mktemp -d "$folder/work.XXXXXX")
trap 'rm -rf "$work"' EXIT

bash "$recipe/build_kernel.sh" "$work/kernel"
abi=$(cat "$work/kernel/abi")

included=$( (sed 's/#.*//' "$recipe/packages"; printf '%s\n' "$@") | xargs | tr ' ' ,)
root=$work/root
mmdebstrap --quiet --variant=minbase --include="$included" --dpkgopt=force-unsafe-io --aptopt='APT::Install-Recommends "false"' \
  --dpkgopt='path-exclude=/usr/share/'{doc,man,locale,info}/'*' --dpkgopt='path-include=/usr/share/doc/*/copyright' \
  bookworm "$root" || { echo "skipped: mmdebstrap cannot make a Debian here"; exit 77; }

# Only the modules that are used, each with those it needs.
tree=$work/kernel/tree
mkdir -p "$root/lib/modules/$abi"
cp "$tree/lib/modules/$abi"/modules.{order,builtin,builtin.modinfo} "$root/lib/modules/$abi"
list_modules() { # MODULE...: their files under $tree, in the order to load them
  local module
  for module; do modprobe -d "$tree" -S "$abi" --show-depends "$module"; done | awk '$1 == "insmod" && !seen[$2]++ {print $2}'
}
mapfile -t files < <(list_modules $(sed 's/#.*//' "$recipe/modules"))
for file in "${files[@]}"; do install -D -m 644 "$file" "$root/${file#"$tree"}"; done
depmod -b "$root" "$abi"

# The machine itself.
echo depthscope-hil >"$root/etc/hostname"
echo 0123456789abcdef0123456789abcdef >"$root/etc/machine-id"
install -m 755 "$recipe/agent.sh" "$root/usr/local/bin/hil-agent"
install -m 644 "$recipe/hil-agent.service" "$recipe/hil-devices.service" "$root/etc/systemd/system"
install -m 755 "$recipe/devices.sh" "$root/usr/local/bin/hil-devices"
install -m 755 "$recipe/capture.sh" "$root/usr/local/bin/hil-capture"
systemctl --quiet --root="$root" enable hil-agent.service hil-devices.service systemd-networkd.service
systemctl --quiet --root="$root" mask apt-daily.timer apt-daily-upgrade.timer dpkg-db-backup.timer systemd-networkd-wait-online.service
mke2fs -q -t ext4 -d "$root" -E root_owner=0:0 -O ^has_journal "$work/root.ext4" 2500M

# What mounts it.
initrd=$work/initrd
mkdir -p "$initrd"/{bin,dev,proc,sys,root,modules}
cp "$tree/bin/busybox" "$initrd/bin"
install -m 755 "$recipe/init" "$initrd/init"
for file in $(list_modules crc32c_generic virtio_pci virtio_blk ext4); do
  cp "$file" "$initrd/modules"
  basename "$file" >>"$initrd/modules/order"
done
(cd "$initrd" && find . | cpio --quiet -o -H newc) >"$work/initrd.cpio"

mv "$work/kernel/vmlinux" "$folder/vmlinux"
mv "$work/initrd.cpio" "$folder/initrd"
mv "$work/root.ext4" "$folder/root.ext4"
