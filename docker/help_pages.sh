#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# help_pages.sh PROGRAM VERSION FOLDER: writes a man page (NAME.1) and completions for bash, fish and zsh, generated from
# the program's --help, and from that of its subcommands where it has some.
set -eu
program=$1 version=$2 folder=$3
name=$(basename "$program")
case $name in
  kerf-agent) subcommands=doctor purpose='carve in a Kerf session with a haptic device' ;;
  kerf-carve) subcommands=tradeoff purpose='carve a block with an NC program' ;;
  kerf-server) subcommands='check replay backup salvage' purpose='sessions in which several people carve one block' ;;
  *) subcommands='' purpose='write the tool paths of the Kerf demo' ;;
esac
mkdir -p "$folder"

# Prints a line "names <TAB> value <TAB> description" for each option of a help text in CLI11's
# layout.
options_of() {
  "$program" "$@" --help | awk '
    function flush() {
      if (names != "") printf "%s\t%s\t%s\n", names, value, description
      names = value = description = ""
    }
    /^  -/ {
      flush()
      head = $0
      if (length($0) > 30 && substr($0, 30, 1) == " ") { head = substr($0, 1, 30); description = substr($0, 31) }
      sub(/^ +/, "", head); sub(/ +$/, "", head)
      names = head; sub(/ .*/, "", names); gsub(/\{[^}]*\}/, "", names); gsub(/!/, "", names)
      value = head; if (!sub(/^[^ ]+ /, "", value)) value = ""
      next
    }
    /^ +[^ ]/ { if (names != "") { sub(/^ +/, ""); description = description (description == "" ? "" : " ") $0 } }
    /^$/ { flush() }
    END { flush() }'
}

man_options() {
  options_of "$@" | awk -F '\t' '
    function escape(text) { gsub(/\\/, "\\e", text); gsub(/-/, "\\-", text); return text }
    { names = $1; gsub(/,/, ", ", names)
      printf ".TP\n\\fB%s\\fR", escape(names)
      if ($2 != "") printf " %s", escape($2)
      printf "\n%s\n", ($3 == "" ? "See above." : escape($3)) }'
}

usage_of() { "$program" "$@" --help | sed -n 's|^[Uu]sage: *[^ ]* *||p'; }
summary_of() { "$program" "$@" --help | sed -n '1{/^[Uu]sage/!p}'; }
escaped() { sed 's/\\/\\e/g; s/-/\\-/g'; }

{
  printf '.TH %s 1 "" "kerf %s" "Kerf"\n.SH NAME\n%s \\- %s\n' "$(echo "$name" | tr '[:lower:]' '[:upper:]')" "$version" "$name" "$purpose"
  printf '.SH SYNOPSIS\n.B %s\n%s\n' "$name" "$(usage_of | escaped)"
  for subcommand in $subcommands; do
    printf '.br\n.B %s %s\n%s\n' "$name" "$subcommand" "$(usage_of "$subcommand" | sed "s|^$subcommand *||" | escaped)"
  done
  summary=$(summary_of | escaped)
  if [ -n "$summary" ]; then printf '.SH DESCRIPTION\n%s\n' "$summary"; fi
  if [ -n "$(options_of)" ]; then printf '.SH OPTIONS\n'; man_options; fi
  if [ -n "$subcommands" ]; then printf '.SH SUBCOMMANDS\n'; fi
  for subcommand in $subcommands; do
    printf '.SS "%s %s"\n%s\n' "$name" "$subcommand" "$(summary_of "$subcommand" | escaped)"
    man_options "$subcommand"
  done
} >"$folder/$name.1"

# Prints the words that may follow the program's name: long options and subcommands.
words() {
  { options_of; for subcommand in $subcommands; do options_of "$subcommand"; done; } | cut -f1 | tr ',' '\n' | grep '^--' | sort -u
}
{
  echo "# bash completion of $name"
  echo "complete -o bashdefault -o default -W '$(words | tr '\n' ' ')$subcommands' $name"
} >"$folder/$name.bash"

options_of | awk -F '\t' -v name="$name" '
  { count = split($1, names, ","); text = $3; gsub(/\047/, "\\\047", text)
    for (i = 1; i <= count; i++) if (names[i] ~ /^--/)
      printf "complete -c %s -l %s%s -d \047%s\047\n", name, substr(names[i], 3), ($2 == "" ? "" : " -r"), text }
  ' >"$folder/$name.fish"
for subcommand in $subcommands; do
  echo "complete -c $name -n __fish_use_subcommand -a $subcommand" >>"$folder/$name.fish"
done

{
  printf '#compdef %s\n_arguments' "$name"
  options_of | awk -F '\t' '
    { count = split($1, names, ","); text = $3; gsub(/\047/, "\047\\\047\047", text); gsub(/[\[\]:]/, " ", text)
      for (i = 1; i <= count; i++) if (names[i] ~ /^--/)
        printf " \\\n  \047*%s[%s]%s\047", names[i], text, ($2 == "" ? "" : ":value:_files") }'
  printf " \\\\\n  '*:file:_files'\n"
} >"$folder/_$name"
