#!/bin/sh
# Captures a simulated robot with LEDs in its gripper until the gripper is known to 3 mm in the camera's
# frame, calibrates it, and compares the result with the truth.  Run examples/demo.sh first: it builds.
set -eu
cd "$(dirname "$0")/.."

kinecal=build/demo/bin/kinecal
[ -x "$kinecal" ] || ./examples/demo.sh
out=build/demo/capture
rm -rf "$out"

echo "== A robot that differs from its URDF by known errors: $out/truth.yaml"
"$kinecal" simulate examples/mobile_manipulator/mobile_manipulator.urdf --target leds --poses 60 -o "$out"
echo "== kinecal capture"
"$kinecal" capture "$out/capture.yaml" --urdf "$out/robot.urdf" --poses "$out/poses.yaml" \
  --robot "simulated:$out/scene.yaml" -o "$out/samples.yaml" \
  --calibrate "$out/calibrate.yaml" --until "gripper 3 mm" --result "$out/calibrated" \
  --contact-sheet "$out/views.html" --report "$out/report.html"
echo
echo "Look at it in a browser: $out/report.html"
