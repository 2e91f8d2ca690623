#!/bin/bash
# build_kernel.sh FOLDER: fetches Debian's kernel into FOLDER: `vmlinux`, and under `tree` the modules with
# gpio-sim, which Debian does not build: it is made here out of Debian's own kernel source.
# Exit status 77: the packages cannot be had.
set -euo pipefail
folder=$1
mkdir -p "$folder/packages" "$folder/tree"
cd "$folder"

kernel=$(apt-cache depends linux-image-amd64 | sed -n 's/^ *Depends: \(linux-image-.*\)/\1/p')
[[ -n $kernel ]] || { echo "skipped: apt knows no linux-image-amd64"; exit 77; }
abi=${kernel#linux-image-}
kbuild=linux-kbuild-${abi%%.0-*}
source=linux-source-${abi%%.0-*}
(cd packages && apt-get -qq -o APT::Sandbox::User=root download "$kernel" "linux-headers-$abi" "linux-headers-${abi%-amd64}-common" "$kbuild" "$source" \
  busybox-static) || { echo "skipped: the kernel's packages cannot be downloaded"; exit 77; }
for package in packages/*.deb; do
  [[ $package == */linux-source* ]] || dpkg-deb --extract "$package" tree
done

# The few files of the source that are needed.
archive=./usr/src/$source.tar.xz
dpkg-deb --fsys-tarfile packages/linux-source*.deb | tar -x "$archive"
tar -xJf "$archive" --strip-components=1 --occurrence=1 \
  "$source"/{drivers/gpio/gpio-sim.c,drivers/gpio/gpiolib.h,kernel/irq/irq_sim.c,scripts/extract-vmlinux}
sh scripts/extract-vmlinux "tree/boot/vmlinuz-$abi" >vmlinux

# A module may not use irq_to_desc; the exported call does the same.
mkdir module
cp drivers/gpio/gpio-sim.c drivers/gpio/gpiolib.h kernel/irq/irq_sim.c module
sed -i 's/handle_simple_irq(irq_to_desc(irqnum))/generic_handle_irq_safe(irqnum)/' module/irq_sim.c
echo 'MODULE_LICENSE("GPL");' >>module/irq_sim.c
printf 'obj-m := gpio-sim.o irq_sim.o\nccflags-y := -DCONFIG_IRQ_SIM=1\n' >module/Makefile
headers=$PWD/tree/usr/src
sed -i "s#/usr/src/#$headers/#" "$headers/linux-headers-$abi/Makefile"
make -s -C "$headers/linux-headers-$abi" M="$PWD/module" modules
mkdir -p "tree/lib/modules/$abi/extra"
cp module/*.ko "tree/lib/modules/$abi/extra"
depmod -b tree "$abi"
echo "$abi" >abi
