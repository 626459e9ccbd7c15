# Named checks that all run, whatever became of those before. Sourced by .ci/run and scripts/nightly:
#
#   source scripts/lib/checks.sh
#   select_checks "$@"            --list, --only NAME (a part of the name; may stand several times)
#   check "tests" scripts/test    runs the rest of the line unless it is not wanted
#   check_beside "pages" script   the same, beside the checks that follow: for what waits more than it computes
#   join_checks                   waits for those, and shows what they said; end_checks does so, too
#   end_checks                    what those that failed said, what tests left out, a table of times, and the exit status
#
# After select_checks, `rest` holds the arguments that it did not know.
#
# shellcheck shell=bash

checks_passed=()
checks_failed=()
checks_beside=()
checks_said=$(mktemp -d)
checks_only=()
checks_list=false
trap 'rm -rf "$checks_said"' EXIT

select_checks() {
  rest=()
  while (($#)); do
    case "$1" in
      --list) checks_list=true ;;
      --only)
        [[ -n "${2:-}" ]] || {
          printf '%s: --only needs the name of a check, or a part of it\n' "$0" >&2
          exit 2
        }
        checks_only+=("$2")
        shift
        ;;
      *) rest+=("$1") ;;
    esac
    shift
  done
}

# What the checks so far have had of all processors, in seconds; of processes that ended and were waited for.
processor_seconds() {
  local fields
  read -ra fields </proc/$$/stat
  printf '%d' $(((fields[15] + fields[16]) / $(getconf CLK_TCK)))
}

# True if a check of this name is to run; for what only some checks need prepared.
is_wanted() {
  $checks_list && return 1
  ((${#checks_only[@]} == 0)) && return 0
  local part
  for part in "${checks_only[@]}"; do
    [[ "$1" == *"$part"* ]] && return 0
  done
  return 1
}

# The same, for a check itself: it is named where names are asked for.
is_to_run() {
  $checks_list && printf '%s\n' "$1"
  is_wanted "$1"
}

check() {
  local name=$1
  shift
  is_to_run "$name" || return 0
  printf '\n== %s\n' "$name"
  local said="$checks_said/${name//\//_}" start=$SECONDS used
  used=$(processor_seconds)
  # Not called from an `if`, where `set -e` would not hold inside the function that is run.
  set +e
  (
    set -e
    "$@"
  ) 2>&1 | tee "$said"
  local status=${PIPESTATUS[0]}
  set -e
  note_check "$status" $((SECONDS - start)) $(($(processor_seconds) - used)) "$name"
}

# What became of a check: its exit status, seconds, seconds of all processors, name.
note_check() {
  local status=$1 seconds=$2 used=$3 name=$4
  if ((status == 0)); then
    checks_passed+=("$seconds $used $name")
    printf -- '-- %s: passed in %d s\n' "$name" "$seconds"
  else
    checks_failed+=("$seconds $used $name")
    printf -- '-- %s: FAILED after %d s\n' "$name" "$seconds"
  fi
}

check_beside() {
  local name=$1
  shift
  is_to_run "$name" || return 0
  printf '\n== %s begins, beside what follows\n' "$name"
  local said="$checks_said/${name//\//_}"
  (
    trap 'printf "%d" "$SECONDS" >"$said.end"' EXIT
    set -e
    "$@"
  ) >"$said" 2>&1 &
  checks_beside+=("$! $SECONDS $name")
}

join_checks() {
  local each process start name said status used
  for each in "${checks_beside[@]}"; do
    read -r process start name <<<"$each"
    said="$checks_said/${name//\//_}"
    printf '\n== %s\n' "$name"
    # The processors' time of a process is counted when it is waited for.
    used=$(processor_seconds)
    status=0
    wait "$process" || status=$?
    cat "$said"
    note_check "$status" $(($(<"$said.end") - start)) $(($(processor_seconds) - used)) "$name"
    rm "$said.end"
  done
  checks_beside=()
}

end_checks() {
  $checks_list && exit 0
  join_checks
  local each name
  for each in "${checks_failed[@]}"; do
    name=${each#* * }
    printf '\n== what %s said: errors, and the end\n' "$name"
    grep -nE 'error:|ERROR:|FAILED|\*\*\*|Failure|runtime error|AssertionError' "$checks_said/${name//\//_}" |
      head -n 60 || true
    tail -n 40 "$checks_said/${name//\//_}"
  done
  if grep -qrsh '^left out: ' "$checks_said"; then
    printf '\n== what tests left out\n'
    grep -rsh '^left out: ' "$checks_said" | sort -u
  fi
  printf '\n== seconds, and seconds of all processors\n'
  {
    ((${#checks_passed[@]} == 0)) || printf '%s\n' "${checks_passed[@]}"
    ((${#checks_failed[@]} == 0)) || printf '%s FAILED\n' "${checks_failed[@]}"
  } | sort -k 1,1nr | awk '{ seconds = $1; used = $2; $1 = $2 = ""; total += seconds; all += used
                             printf "%6d %6d %s\n", seconds, used, $0 }
                           END { printf "%6d %6d   together\n", total, all }'
  printf '\n'
  ((${#checks_failed[@]} == 0)) || printf 'failed: %s\n' "${checks_failed[@]#* * }"
  printf '%d passed, %d failed\n' "${#checks_passed[@]}" "${#checks_failed[@]}"
  if ((${#checks_passed[@]} + ${#checks_failed[@]} == 0)); then
    printf '%s: no check is called "%s"; --list names them\n' "$0" "${checks_only[*]}" >&2
    exit 2
  fi
  ((${#checks_failed[@]} == 0)) && exit 0
  exit 1
}
