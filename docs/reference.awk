# SPDX-License-Identifier: MIT OR Apache-2.0
# reference.awk -- turns a header of bhr's into one that Doxygen makes a reference of: the first comment becomes the
# file's description, with its headings, and each section of the header a module, which is named after both, because
# sections of several headers, and guides, may be called alike. docs/build runs it with header (the file as programs
# include it).
#
# In the first comment a heading is alone in its line and not indented, and what belongs to it is indented by two
# columns; under "Example" there is code.
#
# Doxygen takes the text up to the first dot before a space for a summary. The dots of ranges ("0 .. 1") and of
# abbreviations end no sentence: no plain space follows those, and a backslash those of abbreviations.
BEGIN { prefix = header; gsub(/[^a-z]/, "_", prefix) }
function close_code() { if (code) print " * @endcode"; code = 0 }
FNR == 1 && /^\/\* / {
    first = 1
    sub(/^\/\* /, "")
    name = $1
    sub(/^[^ ]+ -- /, "")
    print "/** @file " name
    print " * @brief " toupper(substr($0, 1, 1)) substr($0, 2)
    next
}
first && /\*\/ *$/ {
    close_code()
    first = 0
    print
    next
}
first && title_next && /^ \* [^ ]/ && !/[.,;:]$/ && length($0) < 40 {
    close_code()
    sub(/^ \* /, "")
    print " * @par " $0
    if ($0 == "Example") {
        print " * @code{.cpp}"
        code = 1
    }
    next
}
first {
    title_next = $0 ~ /^ \*$/
    sub(code ? "^ [*]   " : "^ [*] +", " * ")
    # A tag that is spoken of is no tag.
    gsub(/"@/, "\"@@")
    print
    next
}
/^\/\* ---- .* ---- \*\/$/ {
    sub(/^\/\* ---- /, "")
    sub(/ ---- \*\/$/, "")
    if (sections++) print "/** @} */"
    printf "/** @defgroup %s_%d %s (%s)\n * @{ */\n", prefix, sections, toupper(substr($0, 1, 1)) substr($0, 2), header
    next
}
/^#ifdef __cplusplus/ && sections { print "/** @} */"; sections = 0 }
# Compilers warn by it; it says nothing to readers.
/^#define BHR_NODISCARD/ { next }
{
    sub(/^BHR_NODISCARD /, "")
    gsub(/ \.\. /, " ..\\&nbsp;")
    sub(/ \.\.$/, " ..\\&nbsp;")
    line = ""
    while (match($0, /(^| )\(?(e\.g|i\.e|al|cf|Rec)\.( |$)/)) {
        line = line substr($0, 1, RSTART + RLENGTH - 1)
        sub(/ ?$/, "\\ ", line)
        $0 = substr($0, RSTART + RLENGTH)
    }
    print line $0
}
