#!/usr/bin/env bash
# scripts/findings on results made up: findings.sh SOURCE PROGRAM
# Sentences that hold and that do not; missing files, figures and checkouts; broken templates.
set -euo pipefail
source=$(realpath "$1") program=$(realpath "$2")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$work/scripts" "$work/build/release" "$work/findings" "$work/data"
cp "$source/scripts/findings" "$work/scripts/"
ln -s "$program" "$work/build/release/bvhbench"
cd "$work"
own=$("$program" --version | sed 's/.*(\(.*\))$/\1/')

fail() {
    echo "findings.sh: $1" >&2
    exit 1
}
# findings STATUS TEXT OPTION...: ends with this status and says this on standard error
findings() {
    local status=0
    scripts/findings --data data --template t.md --out F.md "${@:3}" >stdout 2>stderr || status=$?
    [ $status = "$1" ] && grep -qF -- "$2" stderr || fail "${*:3}: status $status, not $1 with '$2': $(cat stderr)"
    [ ! -s stdout ] || fail "it printed: $(cat stdout)"
}
template() { # PROGRAM [SENTENCE]
    printf '# Head\n\n```data forged\nbvhbench stress --axis outlier\n```\n\n```jq\ndef twice: 2 * .;\n```\n\n### Title\n\n%s\n\n```jq forged\n%s\n```\n' \
        "${2-It fails at {{at\}\}, twice is {{twice\}\}.}" "$1" >t.md
}
forge() { # AT CPU NAME [REVISION]
    mkdir -p "data/$3"
    cat >"data/$3/stress.json" <<END
{"schema":"bvhbench-table/1","command":"stress","columns":[],"rows":[
{"cpu":"$2","cpu_threads":2,"device":"a device","revision":"${4-$own}","date":"2024-01-02T03:04:05Z","command":"bvhbench stress --axis outlier --quiet --out /somewhere/else"},
{"builder":"lbvh","question":"outlier","at":$1}]}
END
}
good='[.rows[] | select(.builder == "lbvh") | .at][0] as $at | {at: $at, twice: ($at | twice), holds: ($at > 10)}'

# A sentence that holds is written with its figures, its command and its machine.
template "$good"
forge 20 'A processor' forged
findings 0 '1 sentences, 1 hold'
cat >expected <<END
# Head

Measured on A processor, 2 threads, a device; bvhbench $own.

## Title

It fails at 20, twice is 40.

\`bvhbench stress --axis outlier --quiet --out /somewhere/else\`, 2024-01-02
END
diff expected F.md || fail 'FINDINGS.md is not what was expected'
rm F.md
findings 0 'holds: Title' --check
[ ! -e F.md ] || fail '--check wrote a file'

# Of several runs a figure is the median, with its span; each run must hold.
template '[.rows[] | select(.builder == "lbvh") | .at][0] as $at
    | {at: {value: $at, low: ($at - 0.5), high: ($at + 2)}, twice: ($at | twice), holds: ($at > 10)}' \
    'At {{at}} ({{at span}}), twice {{twice}}.'
sed -i 's/^```data forged/```data forged 3/' t.md
forge 11 'A processor' forged-2
forge 12.5 'A processor' forged-3
findings 0 'holds: Title: At 12.5 (10.5 to 22.0), twice 22 or 25 or 40.' --check
findings 0 '1 hold'
grep -qF 'else`, 3 runs, 2024-01-02' F.md || fail "the number of runs is not said: $(cat F.md)"
forge 5 'A processor' forged-2
findings 1 'does not hold: Title: At 12.5 (4.50 to 22.0)' --check
rm -r F.md data/forged-2 data/forged-3
template "$good"

# One that does not is said with its figures, and left out.
forge 5 'A processor' forged
findings 1 'does not hold: Title: ' --check
grep -qF 'It fails at 5, twice is 10.' stderr || fail 'the figures that do not hold are not said'
[ ! -e F.md ] || fail '--check wrote a file'
findings 1 '1 sentences, 0 hold'
! grep -q Title F.md || fail 'a sentence that does not hold was written'
rm F.md

# What is missing ends with status 2, and writes nothing.
forge 20 'A processor' forged
template "$good" 'No {{such}} figure.'
findings 2 "'Title': jq: error"
grep -qF 'no figure such' stderr || fail "the missing figure is not named: $(cat stderr)"
template '{at: 1, twice: 2}'
findings 2 'no {holds: true or false}'
template '{at: null, twice: 2, holds: true}'
findings 2 'no figure at'
template '[.rows[] | nonsense]'
findings 2 "'Title'"
template "$good"
mv data/forged/stress.json kept
findings 2 'neither results.json nor stress.json'
echo '{"rows": 3' >data/forged/stress.json
findings 2 'is no result file'
echo '{"schema":"bvhbench-table/1"}' >data/forged/results.json
findings 2 'results.json'
rm data/forged/results.json
mv kept data/forged/stress.json
[ ! -e F.md ] || fail 'something was written'

# Results of two machines do not make one page.
{ cat t.md; printf '```data other\nfalse\n```\n'; } >two.md
mv two.md t.md
forge 20 'Another processor' other
findings 2 'several machines'
forge 20 'A processor' other abc
findings 2 "measured by revision abc, and this program is $own"
rm -r data/other

# Commands run if there are no results; a failing one is named. Without checkouts, it is left out.
findings 2 'false: ' # `false --out ...`: status 1, and no results
sed -i 's/^false$/true "$PEERS"/' t.md
findings 0 'other: no checkouts'
{ cat t.md; printf '### Peers\n\nThey fail at {{at}}.\n\n```jq other\n%s\n```\n' "$good"; } >two.md
mv two.md t.md
findings 1 'not measured: Peers'
findings 1 'not measured: Peers' --check
template "$good"
sed -i 's/^bvhbench stress.*/bvhbench stress --axis nowhere/; s/data forged/data anew/; s/jq forged/jq anew/' t.md
findings 2 'nowhere'
template "$(tr -d '\n' <<'END'
.summary.choices[0].rows[0] as $r | {at: $r.builder, twice: (.summary.counts[0] | twice), holds: ($r.trace.low > 0)}
END
)"
sed -i 's/^bvhbench stress.*/bvhbench run --scene random:n=50 --builder lbvh --kernel stack --rays primary --size 24x24 --repeats 6 --no-pictures --charts no/; s/forged/run/' t.md
findings 0 '1 hold'
grep -qF 'It fails at lbvh, twice is 200000.' F.md || fail "the summary's figures are not there: $(cat F.md)"
before=$(stat -c %Y.%s data/run/results.json)
findings 0 'holds' --check
[ "$before" = "$(stat -c %Y.%s data/run/results.json)" ] || fail 'results that were there were measured again'

sed -i 's/--repeats 6/--repeats 7/' t.md
findings 2 'measured by another command'

# Broken templates are named by line.
broken() {
    printf "$1" >t.md
    findings 2 "t.md$2"
}
broken '```data a\ntrue\n' ':1: the block does not end'
broken '# Head\n```sh\ntrue\n```\n' ":2: a block is 'data NAME [RUNS]'"
broken '```data a 12\ntrue\n```\n' ":1: a block is 'data NAME [RUNS]'"
broken '### One\n\n### Two\n' ":3: the sentence before, 'One', has no block"
broken '### One\ntext\n' ":2: the sentence 'One' has no block"
broken '```data a\ntrue\n```\n```jq a\n{}\n```\n' ":4: this block follows no"
broken '### One\n```jq a\n{}\n```\n' ":2: there is no block 'data a' above"
broken 'text\n' ':1: there is no sentence'
findings 2 'cannot be read' --template nowhere.md
findings 2 'no option' --fast
findings 2 'no folder' --peers nowhere
findings 2 'give a value' --out

# The template of the tree is sound, as far as that can be seen without its results: its programs
# compile, and are asked for the figures that their sentences name.
definitions=$(awk '/^```jq$/ { on = 1; next } /^```$/ { on = 0 } on' "$source/findings/template.md")
count=$(grep -c '^```jq [a-z]' "$source/findings/template.md")
[ "$count" -ge 6 ] || fail "findings/template.md has $count sentences"
for n in $(seq "$count"); do
    awk -v n="$n" '/^```jq [a-z]/ { on = ++i == n; next } /^```$/ { on = 0 } on' "$source/findings/template.md" >block
    jq -n "$definitions def figures: $(cat block); 1" >log 2>&1 || fail "block $n of findings/template.md: $(cat log)"
    for figure in $(awk -v n="$n" '/^### / { i++; next } /^```/ { if (i == n) exit } i == n' "$source/findings/template.md" |
        grep -o '{{[a-z_]*[ }]' | tr -d '{} '); do
        grep -qE "[{ ]$figure:" block || fail "block $n of findings/template.md yields no $figure"
    done
done
