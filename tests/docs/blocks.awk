# blocks.awk -- takes the fenced blocks out of a page of Markdown. Each is written to FOLDER/N.LANGUAGE, and a line says
# what it is: its number, its line in the page, its language, and the comment <!-- ... --> on the line before its fence.
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
{
    said = ""
    if ($0 ~ /^ *<!-- .* -->$/) {
        said = $0
        gsub(/^ *<!-- | -->$/, "", said)
    }
}
END { if (inside) printf "%d\t%d\tnone\tnot closed\n", number, NR }
