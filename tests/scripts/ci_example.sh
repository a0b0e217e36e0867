#!/usr/bin/env bash
# The steps of examples/ci/bvhbench.yml, run as they stand in a folder with a base and a head whose
# scripts are stubs around this build: ci_example.sh SOURCE PROGRAM. Skips without Python's yaml.
set -euo pipefail
source=$(realpath "$1") program=$(realpath "$2")
python=/usr/bin/python3
"$python" -c 'import yaml' 2>/dev/null || { echo 'skipped: no python3-yaml'; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
fail() {
    echo "ci_example.sh: $1" >&2
    exit 1
}

"$python" - "$source/examples/ci/bvhbench.yml" <<'END'
import sys, yaml
flow = yaml.safe_load(open(sys.argv[1]))
assert flow['defaults']['run']['shell'] == 'bash'
steps = flow['jobs']['compare']['steps']
assert [s['with']['path'] for s in steps if s.get('uses', '').startswith('actions/checkout@')] == ['base', 'head']
uploaded = [s['with']['path'] for s in steps if s.get('uses', '').startswith('actions/upload-artifact@')]
open('uploaded', 'w').write('\n'.join(uploaded) + '\n')
for step in steps:
    if 'run' in step:
        open(step['name'].split(',')[0] + '.sh', 'w').write(step['run'])
open('env', 'w').write(''.join(f'{name}={value!r}\n' for name, value in flow['env'].items()))
END

for side in base head; do
    mkdir -p $side/scripts
    printf '#!/bin/sh\n' >$side/scripts/setup
    printf '#!/bin/sh\nmkdir -p %s/build/release && ln -sf %q %s/build/release/bvhbench\n' $side "$program" $side >$side/scripts/build
    chmod +x $side/scripts/*
done
export GITHUB_STEP_SUMMARY=$work/summary.md
# step STATUS NAME: as GitHub's `shell: bash`
step() {
    local status=0
    bash --noprofile --norc -eo pipefail "$2.sh" >"$2.log" 2>&1 || status=$?
    [ $status = "$1" ] || fail "the step $2 ended with $status, not $1: $(tail -5 "$2.log")"
}

# Its options are those of the program; a tiny scene stands in for what they choose.
. ./env
"$program" run $ARGUMENTS --help >log && "$program" compare $PAIRS --help >log || fail "the workflow's options: $(cat log)"
export PAIRS='--rounds 7' ARGUMENTS='--scene random:n=50 --builder lbvh,sah --kernel stack --rays primary --size 24x24 --repeats 1'
step 0 Build
# Equal programs are not worse, whatever the noise of rounds this short: only times of half again count.
PAIRS+=' --threshold 1000' step 0 Compare
grep -q '|' summary.md || fail "the summary has no table: $(cat summary.md)"
step 0 Page
while read -r file; do
    [ -s "$file" ] || fail "$file is uploaded, but not there"
done <uploaded

# A head that lost a builder fails, and says which on the summary.
rm head/build/release/bvhbench summary.md
printf '#!/bin/bash\n[ "$1" != run ] || set -- "${@/lbvh,sah/lbvh}"\nexec %q "$@"\n' "$program" >head/build/release/bvhbench
chmod +x head/build/release/bvhbench
step 1 Compare
grep -q 'builder=sah\|sah' summary.md || fail "the lost builder is not on the summary: $(cat summary.md)"
# One that does not build fails too.
printf '#!/bin/sh\nexit 3\n' >head/scripts/build
step 3 Build
