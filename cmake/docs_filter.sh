#!/bin/sh
# Filter of Doxygen: prints a header with the comment at its top as the documentation of the file.
# Line numbers stay the same: \file takes the place of the licence line.  Tags such as <arg> in
# comments are text, not HTML.
exec awk '
  function doc(line,  start, text) {
    start = index(line, "///")
    text = substr(line, start)
    if (start > 0 && text !~ /`/ && text !~ /^\/\/\/    /) gsub(/<[a-z]/, "\\\\&", text)
    return substr(line, 1, start - 1) text
  }
  head_over { print doc($0); next }
  NR == 1 && /^\/\/ / { print "/// \\file"; text = doc("///" substr($0, 3)); next }
  /^\/\/ SPDX/ { print text; head_over = 1; next }
  /^\/\/   / { print text; text = "///    " substr($0, 3); next }
  /^\/\// { print text; text = doc("///" substr($0, 3)); next }
  { if (text != "") print text; text = ""; print; head_over = 1 }
' "$1"
