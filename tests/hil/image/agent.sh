#!/bin/sh
# Runs what the host asks for, one command a line, and answers with its output, each line led by a space, and a
# last line "=STATUS".
exec 3<>/dev/virtio-ports/depthscope.hil
echo "=ready" >&3
while IFS= read -r command <&3; do
  output=$(sh -c "$command" 2>&1 </dev/null 3<&-)
  status=$?
  { printf '%s\n' "$output" | sed 's/^/ /'; echo "=$status"; } >&3
done
