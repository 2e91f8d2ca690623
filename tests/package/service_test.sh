#!/bin/sh
# service_test.sh UNIT: the service's exposure as systemd rates it is at most 1.0, and it reaches the devices
# it needs and no other.
set -eu
unit=$1

command -v systemd-analyze >/dev/null || { echo "skipped: systemd-analyze is not installed (package systemd)"; exit 77; }

# The threshold is in tenths.
report=$(systemd-analyze security --offline=true --no-pager --threshold=10 "$unit") || {
  echo "$report"
  echo "FAILED: the exposure is above 1.0"
  exit 1
}
echo "$report" | grep "Overall exposure"

grep -qx "DevicePolicy=closed" "$unit" || { echo "FAILED: DevicePolicy is not closed"; exit 1; }
allowed=$(sed -n 's/^DeviceAllow=\([^ ]*\).*/\1/p' "$unit" | sort | tr '\n' ' ')
expected="char-drm char-fb char-gpiochip char-input char-video4linux "
[ "$allowed" = "$expected" ] || { echo "FAILED: devices allowed: $allowed, expected $expected"; exit 1; }

# The watchdog, the notification and the restart that the promises rest on.
for line in Type=notify Restart=always StartLimitIntervalSec=0; do
  grep -qx "$line" "$unit" || { echo "FAILED: $line is missing"; exit 1; }
done
grep -q "^WatchdogSec=" "$unit" || { echo "FAILED: WatchdogSec is missing"; exit 1; }
