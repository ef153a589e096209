# SPDX-License-Identifier: MIT OR Apache-2.0
# blocks.awk -- takes the fenced blocks out of a page of Markdown. Each is written to FOLDER/N.LANGUAGE, and a line says
# what it is: its number, its line in the page, its language, and the comment <!-- ... --> on the line before its fence.
# Indented blocks have no fence: a line of shell in one is a block of its own, one of C is in the language "indented".
# The caller sets folder.
!inside && /^ *```/ {
    language = $0
    gsub(/[ `]/, "", language)
    indent = match($0, /`/) - 1
    inside = 1
    file = folder "/" ++number "." (language == "" ? "none" : language)
    printf "" >file
    printf "%d\t%d\t%s\t%s\n", number, NR, language == "" ? "none" : language, said
    said = ""
    next
}
inside && /^ *``` *$/ { inside = 0; close(file); next }
inside { print substr($0, indent + 1) >file; next }
/^    ([.]\/|[A-Z_]+=|(build|docs|packaging|python|tests)\/[a-z]|(cargo|cc|cmake|ffmpeg|git|node|pip) )/ {
    file = folder "/" ++number ".sh"
    print >file
    close(file)
    printf "%d\t%d\tsh\t\n", number, NR
}
/^    #include/ { printf "%d\t%d\tindented\t\n", ++number, NR }
{
    said = ""
    if ($0 ~ /^ *<!-- .* -->$/) {
        said = $0
        gsub(/^ *<!-- | -->$/, "", said)
    }
}
END { if (inside) printf "%d\t%d\tnone\tnot closed\n", number, NR }
