# Turns the options of `PROGRAM --help` into a list of mdoc.
function escape(text) {
  gsub(/\\/, "\\e", text)
  gsub(/^[.']/, "\\\\\\&&", text)
  return text
}
function flush_item() {
  if (item != "") {
    print item
    if (words !~ /^pneulab/) words = toupper(substr(words, 1, 1)) substr(words, 2)
    if (words != "") print escape(words) (words ~ /[.]$/ ? "" : ".")
  }
  item = words = ""
}
/^ +(-[A-Za-z], )?--[a-z]/ {
  flush_item()
  line = $0
  sub(/^ +/, "", line)
  at = index(line, "  ")
  head = at ? substr(line, 1, at - 1) : line
  words = at ? substr(line, at + 2) : ""
  sub(/^ +/, "", words)
  item = ".It"
  count = split(head, parts, " ")
  argument = ""
  for (i = 1; i <= count; i++) {
    part = parts[i]
    if (part ~ /^--/) item = item " Fl \\-" substr(part, 3)
    else if (part ~ /^-.,$/) item = item " Fl " substr(part, 2, 1) " ,"
    else if (argument == "") argument = part
    else words = words (words == "" ? "" : " ") part # its help follows after one space
  }
  if (argument != "") {
    gsub(/\|/, " | ", argument)
    item = item " Ar " argument
  }
  next
}
item != "" && /^            +/ {
  line = $0
  sub(/^ +/, "", line)
  words = words (words == "" ? "" : " ") line
  next
}
{ flush_item() }
END { flush_item() }
