#!/usr/bin/env bash
# The commands of README.md and examples/README.md run as they stand: readme.sh SOURCE PROGRAM.
# Those of `sh` blocks run in a copy of the checkout's top, around a program that adds options to be
# quick; the scripts that other blocks call must be there.
set -euo pipefail
source=$1
program=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

fail() {
    echo "readme.sh: $1" >&2
    exit 1
}

mkdir -p "$work/build/release"
ln -s "$source/examples" "$source/framework" "$source/kernels" "$work/"
# The last of two equal options would be refused: none of those added here is in README.md. Papers
# and checks of all scenes take minutes: of a paper only the options are read.
cat >"$work/build/release/bvhbench" <<END
#!/bin/bash
case \$1 in
run) case "\$*" in *--help*) ;; *--cell*) set -- "\$@" --repeats 1 --charts no --no-pictures ;;
    *) set -- "\$@" --repeats 1 --size 16x16 --max-rays 64 --charts no --no-pictures ;; esac ;;
check) set -- "\$@" --scene cube --side 6 ;;
render) set -- "\$@" --size 16x16 ;;
animate) set -- "\$@" --size 16x16 --max-rays 64 --repeats 1 --frames 0..2 --quiet ;;
report) case "\$*" in *--history*) ;; *) set -- "\$@" --charts no ;; esac ;;
reproduce) grep -q "^  \$2 " <<<"\$("$program" list papers)" || exit 3; set -- "\$@" --help ;;
esac
exec "$program" "\$@"
END
chmod +x "$work/build/release/bvhbench"

# The lines of blocks that begin with ```$1, without comments.
lines() {
    awk -v fence="\`\`\`$1" '/^```/ { inside = !inside && $0 == fence; next } inside' \
        "$source/README.md" "$source/examples/README.md" | sed 's/ *#.*//'
}

cd "$work"
ran=0
while IFS= read -r command; do
    [ -n "$command" ] || continue
    bash -c "$command" >"$work/said" 2>&1 </dev/null ||
        fail "exit status $? of: $command: $(cat "$work/said")"
    ran=$((ran + 1))
done < <(lines sh)
[ $ran -ge 10 ] || fail "only $ran commands"
for file in out/results.json out/report.html out/scorpion.png; do
    [ -s $file ] || fail "$file was not written"
done
while read -r script _; do
    case $script in
    scripts/*) [ -x "$source/$script" ] || fail "there is no $script" ;;
    esac
done < <(lines '')
# What the page says of its figures is what README says.
for words in 'No tracer is taken as the truth'; do
    for file in README.md framework/report/page/report.html; do
        grep -qF "$words" "$source/$file" || fail "$file does not say: $words"
    done
done
echo "readme: ok, $ran commands"
