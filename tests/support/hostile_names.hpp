// Names that mean something to a shell, a page, a table, a configuration or a launch file.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>

namespace kinecal::test {

/// Names that are allowed wherever names are free.  Whoever obeys one of them makes a file PWNED.
inline const std::array<std::string, 44> kHostileNames = {
    // shells
    "`touch PWNED`", "$(touch PWNED)", "x$(touch PWNED)y", "${HOME}", "a;touch PWNED",
    "a|touch PWNED", "a&touch PWNED", "a>PWNED", "it's", "'; touch PWNED; '", "\"; touch PWNED; \"",
    "two  blanks", " blank ", "-rf", "--force", "=cmd", "~", "*", "!!", "#no", "back\\slash", "\\n",
    // roslaunch
    "$(env HOME)", "$(eval 1+1)",
    // tables
    "+1", "@SUM(1)", "=HYPERLINK(1)", "a,b", "'quoted", "\"quoted\"",
    // YAML
    "a: b", "a #b", "- a", "{a}", "[a]", "*alias", "&anchor", "!tag", "%TAG", "null", "1e3",
    // pages
    "<script>alert(1)</script>", "</script><script>alert(1)</script>", "\" onload=\"alert(1)&amp;"};

/// Names that end a line, control a terminal or are not UTF-8: they are refused.
inline const std::array<std::string, 5> kRefusedNames = {"a\nverdict: good", "a\rb", "a\x1b[31mb",
                                                         "a\u2028b", "a\u0085b"};

}  // namespace kinecal::test
