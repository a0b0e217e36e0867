# Completion of bvhbench's command line in bash: `source` it, or install it (CMake does, where bash-completion finds it).
# Nothing is listed here: commands and options are what `--help` says, names and their keys what `list` says.

# Names of a kind (builders, kernels ...); FILE.ending stands for files, which bash completes.
_bvhbench_names()
{
    "$1" list "$2" 2>/dev/null | sed -n -e '/^  FILE\./d' -e 's/^  \([^ ]\{1,\}\) .*/\1/p'
}

# `KEY=` of all options of a name; with $4, a key, `KEY=VALUE` for each of its values.
_bvhbench_keys()
{
    "$1" list "$2" 2>/dev/null | awk -v name="$3" -v key="$4" '
        /^  [^ ]/ { inside = $1 == name }
        inside && /^      [^ ]/ {
            found = $1
            sub(/=.*/, "", found)
            if (key == "")
                print found "="
            else if (found == key && $NF ~ /[|]/) {
                count = split($NF, values, "|")
                for (i = 1; i <= count; i++)
                    print key "=" values[i]
            }
        }'
}

# What may follow in a list of specifications: NAME, NAME:KEY=VALUE,KEY=VALUE, A+B, several by commas.
_bvhbench_specs()
{
    local program=$1 kind=$2 current=$3 key= item name head word
    item=${current##*[,+]}
    head=${current%"$item"}
    name=$item
    if [[ $item == *:* ]]; then
        name=${item%%:*} item=${item#*:} head=$head$name:
    elif [[ $item == *=* || ( $current == *:*,* && $current != *+ ) ]]; then
        name=${current%:*} name=${name##*[,+]} # a comma after a parameter may be followed by one more
    fi
    [[ $item != *=* ]] || key=${item%%=*}
    {
        if [[ $head == *: || -n $key ]]; then
            _bvhbench_keys "$program" "$kind" "$name" "$key"
        else
            [[ $name == "$item" ]] || _bvhbench_keys "$program" "$kind" "$name" ""
            _bvhbench_names "$program" "$kind"
            [[ -n $head ]] || echo all
        fi
    } | while read -r word; do [[ $word != "$item"* ]] || echo "$head$word"; done
}

# Options of a command with their arguments, one per line: `--scene S`.
_bvhbench_options()
{
    "$1" "$2" --help 2>/dev/null | sed -n -e 's/^  -h, --help.*/--help/p' \
        -e 's/^  \(--[a-z-]\{1,\}\( [^ ]\{1,\}\)\{0,1\}\)  *[^ ].*/\1/p'
}

# Words that an option takes: `--format text|github`.
_bvhbench_choices()
{
    local option words
    while read -r option words; do
        [[ $option != "$3" || $words != *'|'* ]] || echo "${words//|/ }"
    done < <(_bvhbench_options "$1" "$2")
}

_bvhbench_commands()
{
    "$1" --help 2>/dev/null | sed -n '/^commands:/,/^$/s/^  \([a-z]\{1,\}\) .*/\1/p'
}

_bvhbench_value()
{
    local choices
    choices=$(_bvhbench_choices "$1" "$2" "$3")
    if [[ -n $choices ]]; then
        compgen -W "$choices" -- "$4"
        return
    fi
    case $3 in
    --scene | --builder | --tracer | --kernel | --intersector) _bvhbench_specs "$1" "${3#--}s" "$4" ;;
    --rays | --metrics) _bvhbench_specs "$1" "${3#--}" "$4" ;;
    --axis) _bvhbench_names "$1" axes ;;
    --transfer) _bvhbench_names "$1" transfers ;;
    --device) _bvhbench_names "$1" devices ;;
    esac
    case $3 in
    --builder | --kernel | --intersector | --rays | --metrics | --device | --shard | --threshold | --rounds) ;;
    *) compgen -f -- "$4" ;;
    esac
}

_bvhbench_words()
{
    local program=$1 current=$2 command=$4 previous=$5 options word
    if [[ $3 -eq 1 ]]; then
        _bvhbench_commands "$program"
        printf '%s\n' --help --version
        return
    fi
    options=$(_bvhbench_options "$program" "$command") || true # `help` has none
    if [[ $current == --*=* ]]; then
        _bvhbench_value "$program" "$command" "${current%%=*}" "${current#*=}" |
            while read -r word; do echo "${current%%=*}=$word"; done
    elif [[ $'\n'$options == *$'\n'"$previous "* ]]; then
        _bvhbench_value "$program" "$command" "$previous" "$current"
    elif [[ $current == -* ]]; then
        sed 's/ .*//' <<<"$options"
    else
        case $command in
        help) _bvhbench_commands "$program" ;;
        list) "$program" list --help | sed -n 's/^usage:.*\[\([a-z|]*\)\]$/\1/p' | tr '|' '\n' ;;
        reproduce) _bvhbench_names "$program" papers ;;
        *) compgen -f -- "$current" ;;
        esac
    fi
}

# Bash breaks words at `:` and `=`, the program does not: the words are those between blanks, and of each reply what bash
# takes for the words before is left out.
_bvhbench()
{
    local line=${COMP_LINE:0:COMP_POINT} current= word breaks
    local -a words
    read -r -a words <<<"$line"
    [[ $line == *[[:blank:]] ]] && words+=("")
    local last=$((${#words[@]} - 1))
    current=${words[last]}
    breaks=${current%"${current##*[:=]}"}
    [[ $COMP_WORDBREAKS == *:* ]] || breaks=
    COMPREPLY=()
    while read -r word; do
        [[ $word == "$current"* ]] && COMPREPLY+=("${word#"$breaks"}")
    done < <(_bvhbench_words "${words[0]}" "$current" "$last" "${words[1]}" "${words[last - 1]}")
    # no blank after what goes on
    [[ ${#COMPREPLY[@]} -ne 1 || ${COMPREPLY[0]} != *[=/] ]] || compopt -o nospace 2>/dev/null || true
}

complete -F _bvhbench bvhbench
