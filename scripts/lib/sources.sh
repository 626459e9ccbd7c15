# Which files there are in which language, and the tools for them. Sourced by scripts/check_format and scripts/lint,
# which stand in the repository's root:
#
#   files_named '*.cpp' '*.hpp'   those that git knows, or would add, one after the other with a NUL behind each
#   shell_scripts                 the same of scripts for shells, which have no ending
#   have TOOL GROUP               false where it is missing; says then how to get it
#
# shellcheck shell=bash
# Variables are for those who source this.
# shellcheck disable=SC2034

ruff=.cache/ci/python/bin/ruff
node_tools=dashboard/node_modules/.bin

files_named() {
  local file
  git ls-files -z --cached --others --exclude-standard -- "$@" |
    while IFS= read -r -d '' file; do
      [[ -e "$file" ]] && printf '%s\0' "$file"
    done
}

shell_scripts() {
  local file line
  files_named "*" | while IFS= read -r -d '' file; do
    if [[ "$file" == *.sh ]]; then
      printf '%s\0' "$file"
    elif [[ "${file##*/}" != *.* && -f "$file" ]]; then
      IFS= read -r line <"$file" 2>/dev/null || continue
      [[ "$line" == '#!'*sh ]] && printf '%s\0' "$file"
    fi
  done
}

have() {
  command -v "$1" >/dev/null && return
  printf '%s: %s is missing; "scripts/setup %s" installs it\n' "$0" "$1" "$2" >&2
  return 1
}
