#!/bin/sh
# Filter of Doxygen: prints a header with the comment at its top as the documentation of the file.
# Line numbers stay the same: \file takes the place of the licence line.  Tags such as <arg> in
# comments are text, not HTML.  Headings of Markdown get the anchors that links to them have elsewhere.
case $1 in *.md)
  name=$(basename "$1" .md)
  exec awk -v name="$name" '
    function anchor(text) {
      text = tolower(text)
      gsub(/[^a-z0-9 _-]/, "", text)
      gsub(/ /, "-", text)
      return text
    }
    /^```/ { code = !code }
    !code && /^##* / {
      id = name "-" anchor(substr($0, index($0, " ") + 1))
      print $0 (seen[id]++ ? "" : " {#" id "}")
      next
    }
    !code {
      gsub(/\]\(#/, "](#" name "-")
      while (match($0, /\]\([A-Z]*\.md#/)) {
        link = substr($0, RSTART + 2, RLENGTH - 6)
        $0 = substr($0, 1, RSTART + 1) "#" link "-" substr($0, RSTART + RLENGTH)
      }
      gsub(/\]\(README\.md\)/, "](index.html)")
      gsub(/\]\((examples|benchmarks|tests|cmake)[^)]*\)/, "]")
    }
    { print }
  ' "$1"
esac
exec awk '
  function doc(line,  start, text) {
    start = index(line, "///")
    text = substr(line, start)
    if (start > 0 && text !~ /`/ && text !~ /^\/\/\/    /) gsub(/<[a-zA-Z]/, "\\\\&", text)
    return substr(line, 1, start - 1) text
  }
  head_over { print doc($0); next }
  NR == 1 && /^\/\/ / { print "/// \\file"; text = doc("///" substr($0, 3)); next }
  /^\/\/ SPDX/ { print text; head_over = 1; next }
  /^\/\/   / { print text; text = "///    " substr($0, 3); next }
  /^\/\// { print text; text = doc("///" substr($0, 3)); next }
  { if (text != "") print text; text = ""; print; head_over = 1 }
' "$1"
