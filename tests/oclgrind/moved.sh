#!/usr/bin/env bash
# Compares the bytes that builds move by the model of framework/device/tally.h with those that oclgrind counts, and prints the errors.
# Fails if one of a builder that framework/simulate/README.md calls validated is above 25 %. Usage: moved.sh FOLDER PLUGIN PROGRAM
set -eu
folder=$1 plugin=$2 program=$3
if ! oclgrind --version 2>/dev/null | grep -q 'Oclgrind 21\.10'; then
    echo "skipped: oclgrind 21.10 is not installed (scripts/setup test)"
    exit 77
fi
validated="lbvh ploc hploc"
mkdir -p "$folder"
status=0
printf '%-20s %-16s %8s %10s %10s %7s\n' scene builder launches model counted error
for scene in soup:n=2000 interior:n=3000; do
    for builder in $validated ${BVHBENCH_MOVED_MORE:-}; do
        if ! MOVED=$folder/moved.txt oclgrind --num-threads 1 --plugins "$plugin" \
            "$program" "$scene" "$builder" >"$folder/model.txt" 2>"$folder/moved.err"; then
            cat "$folder/moved.err"
            exit 1
        fi
        read -r model launches <"$folder/model.txt"
        # the scene's boxes and its seals are no part of the build
        counted=$(awk '$1 != "seal_lines" && $1 != "make_boxes" { sum += $2 } END { print sum + 0 }' \
            "$folder/moved.txt")
        error=$(awk -v m="$model" -v c="$counted" 'BEGIN { printf "%.1f", 100 * (m / c - 1) }')
        printf '%-20s %-16s %8s %10s %10s %6s%%\n' "$scene" "$builder" "$launches" "$model" "$counted" "$error"
        case " $validated " in
        *" $builder "*) awk -v e="$error" 'BEGIN { exit !(e < 25 && e > -25) }' || status=1 ;;
        esac
    done
done
exit $status
