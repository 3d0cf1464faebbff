#!/usr/bin/env bash
# Runs for each submission: reads submission/, writes results/results.json. If a fault of ours prevents
# grading, it contains no score, so Gradescope records none.
EXERCISE=@EXERCISE@
ISOLATION=@ISOLATION@
root=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
results=$root/results/results.json
mkdir -p "$root/results"
rm -f "$results"
"$root/source/venv/bin/python" -I -m grader.gradescope.run "$root/source/course/exercises/$EXERCISE" "$root" $ISOLATION
if [ ! -s "$results" ]; then
    printf '%s\n' '{"output": "This could not be graded, and that is not your fault. Tell your instructor.", "stdout_visibility": "hidden"}' >"$results"
fi
