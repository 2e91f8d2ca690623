#!/bin/sh
# The capture card: one with one HDMI input, fed by one HDMI output.
exec modprobe vivid n_devs=1 node_types=0x101 num_inputs=1 input_types=0x3 num_outputs=1 output_types=0x1 multiplanar=1
