# SPDX-License-Identifier: MIT OR Apache-2.0
# page.awk -- turns a page of Markdown from the repository into one of the site: its links to other pages lead to those
# of the site, and links to files to copies of them, whose names are added to the file `wanted`. Links to folders
# become plain text. docs/build runs it with page (its path in the repository), root, wanted, and pages, a list of
# "PATH=NAME" with spaces around each.
#
# resolved TARGET: its path in the repository.
function resolved(target, parts, n, i, out, depth, stack) {
    out = page
    if (!sub(/\/[^\/]*$/, "/", out)) out = ""
    n = split(out target, parts, "/")
    depth = 0
    for (i = 1; i <= n; i++) {
        if (parts[i] == "..") depth--
        else if (parts[i] != "" && parts[i] != ".") stack[++depth] = parts[i]
    }
    out = ""
    for (i = 1; i <= depth; i++) out = out (i > 1 ? "/" : "") stack[i]
    return out
}
# linked TEXT TARGET: the link for the site, TEXT being "[...]".
function linked(text, target, path, at, name) {
    if (target ~ /^[a-z]+:/ || target ~ /^#/) return text "(" target ")"
    path = resolved(target)
    at = index(pages, " " path "=")
    if (at) {
        name = substr(pages, at + length(path) + 2)
        sub(/ .*/, "", name)
        return text "(" name ".html)"
    }
    if (target ~ /\/$/ || system("test -f '" root "/" path "'") != 0) return substr(text, 2, length(text) - 2)
    print path >>wanted
    return text "(files/" path ".txt)"
}
/^ *```/ { fence = !fence }
fence || /^ *```/ { print; next }
!titled && /^# / {
    titled = 1
    print $0 (name == "index" ? "" : " {#" name "}")
    next
}
# Doxygen shows the tags of code in a title.
/^#/ { gsub(/`/, "") }
{
    # Doxygen knows neither bold code nor, between single backticks, code with an apostrophe.
    out = ""
    line = $0
    while (match(line, /\*\*`[^`]+`\*\*/)) {
        out = out substr(line, 1, RSTART - 1) "<b>" substr(line, RSTART + 2, RLENGTH - 4) "</b>"
        line = substr(line, RSTART + RLENGTH)
    }
    line = out line
    out = ""
    while (match(line, /`[^`]+`/)) {
        code = substr(line, RSTART, RLENGTH)
        if (code ~ /\047/) code = "`" code "`"
        out = out substr(line, 1, RSTART - 1) code
        line = substr(line, RSTART + RLENGTH)
    }
    line = out line
    out = ""
    while (match(line, /\[[^]]*\]\([^) ]+\)/)) {
        whole = substr(line, RSTART, RLENGTH)
        split_at = index(whole, "](")
        out = out substr(line, 1, RSTART - 1) linked(substr(whole, 1, split_at), \
            substr(whole, split_at + 2, length(whole) - split_at - 2))
        line = substr(line, RSTART + RLENGTH)
    }
    line = out line
    out = ""
    while (match(line, /src="[^"]+"/)) {
        path = resolved(substr(line, RSTART + 5, RLENGTH - 6))
        print path >>wanted
        out = out substr(line, 1, RSTART - 1) "src=\"files/" path "\""
        line = substr(line, RSTART + RLENGTH)
    }
    print out line
}
