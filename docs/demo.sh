#!/bin/sh
# The main job on the fixture logs: info, learn, evaluate, and what a camera adds.
set -eu
run() {
    printf '\n$ mpap %s\n' "$*"
    "$BIN/mpap" "$@"
}
OUT=${OUT:-mpap-out}
run info fixtures/indoor-a.bag
run learn fixtures/indoor-a.bag fixtures/indoor-a2.mcap fixtures/indoor-b fixtures/indoor-json.mcap --out "$OUT"
run evaluate --out "$OUT"
run evaluate --feature global-diff --bins 6 --out "$OUT"
run learn fixtures/camera-a.mcap --sensor image --out "$OUT-camera"
run predict "$OUT-camera" fixtures/camera-a.mcap --out "$OUT-camera"
run novelty fixtures/camera-a.mcap fixtures/camera-b.mcap fixtures/camera-a.mcap --window 10 --out "$OUT-camera"
printf '\nOpen in a browser: %s/report.html (laser) and %s-camera/report.html (camera)\n' "$OUT" "$OUT"
