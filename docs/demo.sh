#!/bin/sh
# The main job on the fixture logs: info, learn, evaluate.
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
printf '\nTables and pictures: %s/learn and %s/evaluate\n' "$OUT" "$OUT"
