#!/bin/sh
# The virtual hardware: vivid's HDMI input is /dev/video0, what feeds it /dev/video1; one line of a simulated GPIO
# chip is the footswitch. The display connector is the machine's own.
set -e
modprobe -a virtio_gpu evdev virtio_input virtio_rng configfs
hil-capture

modprobe gpio-sim
mountpoint -q /sys/kernel/config || mount -t configfs configfs /sys/kernel/config
cd /sys/kernel/config/gpio-sim
mkdir -p foot/bank0/line4
echo 8 >foot/bank0/num_lines
echo footswitch >foot/bank0/line4/name
echo 1 >foot/live
