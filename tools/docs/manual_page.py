# SPDX-License-Identifier: Apache-2.0
"""Manual pages in the language of man(7), of programs and their configuration."""
import re
import textwrap


def escaped(text):
    """Returns text that roff shows as it is, minus signs included: people copy options from manual pages."""
    for character, name in (("\\", "\\e"), ("-", "\\-"), ("'", "\\(aq"), ("`", "\\(ga"), ("^", "\\(ha"), ("~", "\\(ti"), ('"', "\\(dq"),
                            (" ..", " ..\\&")):  # of a range, no end of a sentence
        text = text.replace(character, name)
    return text


def capitalised(text):
    """Returns a sentence with a capital letter, but for what is typed so: names of values before a colon ("sgm: ...") and
    addresses ("tcp:HOST:PORT")."""
    return text if re.match(r"\w+(?: and \w+)*: |\w+:\w", text) else text[:1].upper() + text[1:]


def line(text):
    """Returns a line of text; roff takes one that begins with a dot for a request."""
    return "\\&" + text if text.startswith(".") else text


def paragraph(text):
    """Returns lines of at most 100 characters of a paragraph that roff fills."""
    return [line(part) for part in textwrap.wrap(escaped(" ".join(text.split())), 100, break_long_words=False, break_on_hyphens=False)]


def verbatim(lines):
    """Returns lines that stay as they are."""
    return [".nf", *(line(escaped(one)) for one in lines), ".fi"]


class Footer:
    """What stands below the options of --help: notes, examples, and exit status."""

    STATUS = re.compile(r"Exit status: (.*?\.)(?=\s|$)", re.DOTALL)
    EXAMPLE = re.compile(r"^Examples?:(.*)$")
    # "nonocc: only those ..." defines a word.
    DEFINITION = re.compile(r"^[\w, -]{1,40}: ")

    def __init__(self, text):
        status = self.STATUS.search(text)
        self.status = " ".join(status[1].split()) if status else ""
        if status:
            text = text[: status.start()] + text[status.end():].lstrip()
        self.examples, self.notes = [], [[]]
        in_examples = False
        for one in text.splitlines():
            example = self.EXAMPLE.match(one)
            if example:
                in_examples = True
                one = "  " + example[1].strip() if example[1].strip() else ""
            if in_examples and (not one.strip() or one.startswith(" ")):
                if one.strip():
                    self.examples.append(one.strip())
                continue
            in_examples = False
            if not one.strip() or self.DEFINITION.match(one):
                self.notes.append([])
            self.notes[-1].append(one.strip())
        self.notes = [" ".join(note) for note in self.notes if any(note)]

    def statuses(self):
        """Returns [(number, meaning)]; empty where the text has another form."""
        parts = re.split(r"[;,] (?=\d+ )", self.status.rstrip("."))
        found = [re.fullmatch(r"(\d+) (.*)", part) for part in parts]
        return [(one[1], one[2]) for one in found] if all(found) else []


def usage_of(command, path):
    """Returns the line that says how it is called."""
    words = ["\\fB" + escaped(" ".join(path)) + "\\fR", "[\\fIoptions\\fR]"]
    for option in command.positionals():
        name = "\\fI" + escaped(option.names[0]) + "\\fR" + (" ..." if option.several else "")
        words.append(name if option.required else f"[{name}]")
    if command.commands:
        words.append("\\fIcommand\\fR")
    return " ".join(words)


def option_lines(option):
    value = " \\fI" + escaped(option.value) + "\\fR" if option.value and not option.positional else ""
    style = "I" if option.positional else "B"
    names = ", ".join(f"\\f{style}{escaped(name)}\\fR{value}" for name in option.names)
    text = capitalised(option.description).rstrip(".") + "."
    if option.required and not option.positional:
        text += " Must be given."
    if option.default and "default" not in option.description:
        text += f" Default: {option.default}."
    if option.several and "repeated" not in text and "several times" not in text and not option.positional:
        text += " May be repeated."
    if option.needs:
        text += f" Only with {' and '.join(option.needs)}."
    if option.excludes:
        text += f" Not with {', '.join(option.excludes)}."
    return [".TP", names, *paragraph(text)]


def options_section(command):
    lines = []
    if command.positionals():
        lines.append(".SH ARGUMENTS")
        for option in command.positionals():
            lines += option_lines(option)
    lines.append(".SH OPTIONS")
    groups = list(dict.fromkeys(option.group for option in command.flags()))
    for group in sorted(groups, key=lambda name: name != "Options"):
        if group != "Options":
            lines += [".SS", line(escaped(group))]
        for option in command.flags():
            if option.group == group:
                lines += option_lines(option)
    return lines


def head(name, section, date, version, manual):
    return [f'.\\" SPDX-License-Identifier: Apache-2.0; made of the program\'s own options by tools/docs',
            f'.TH {escaped(name.upper())} {section} "{date}" "{version}" "{manual}"',
            ".nh", ".ad l"]  # an option that is cut in two cannot be copied


def tail(command, examples, see_also):
    footer = Footer(command.footer)
    lines = []
    if footer.notes:
        lines.append(".SH NOTES")
        for number, note in enumerate(footer.notes):
            lines += ([".PP"] if number else []) + paragraph(note)
    if footer.status:
        lines.append(".SH EXIT STATUS")
        statuses = footer.statuses()
        for number, meaning in statuses:
            lines += [".TP", f"\\fB{number}\\fR", *paragraph(capitalised(meaning) + ".")]
        if not statuses:
            lines += paragraph(footer.status)
    if examples and footer.examples:
        lines += [".SH EXAMPLES", *verbatim(footer.examples)]
    if see_also:
        lines.append(".SH SEE ALSO")
        named = sorted(see_also, key=lambda page: (page[1], page[0]))
        lines += [f".BR {escaped(name)} ({section})" + ("," if number + 1 < len(named) else "")
                  for number, (name, section) in enumerate(named)]
    return lines


def program_page(command, path, section, date, version, see_also):
    """Returns the page of a program, or of a sub-command where path has two words."""
    name = "-".join(path)
    summary, _, more = command.description.partition(": ") if len(command.description) > 90 else (command.description, "", "")
    lines = head(name, section, date, version, "disparityd")
    lines += [".SH NAME", f"{escaped(name)} \\- " + escaped(summary[:1].lower() + summary[1:].rstrip("."))]
    lines += [".SH SYNOPSIS", usage_of(command, path)]
    lines += [".SH DESCRIPTION", *paragraph(command.description)]
    lines += options_section(command)
    if command.commands:
        lines += [".SH COMMANDS", "Each has a page of its own."]
        for sub in command.commands:
            lines += [".TP", f"\\fB{escaped(sub.name)}\\fR", *paragraph(sub.description)]
    lines += tail(command, True, see_also)
    return "\n".join(lines) + "\n"


def configuration_keys(example):
    """Returns [(section, note, [(comments, [(key, value)])])] of the example of a configuration file: keys that follow a comment
    share it."""
    sections, comments = [], []
    for one in example.splitlines():
        section = re.match(r"^\[(\w+)\]$", one)
        key = re.match(r"^#?(\w+) = (.*)$", one)
        if section:
            sections.append((section[1], " ".join(comments), []))
            comments = []
        elif key and sections:
            if comments or not sections[-1][2]:
                sections[-1][2].append((" ".join(comments), []))
            sections[-1][2][-1][1].append((key[1], key[2]))
            comments = []
        elif one.startswith("#"):
            comments.append(one.lstrip("#").strip())
        else:
            comments = []
    return sections


def configuration_page(example, keys, date, version, see_also):
    """Returns the page of the configuration file. keys: what the program says of them. Raises ValueError where the example
    lacks one of them, or has one too many."""
    allowed = {key["name"]: key["allowed"] for key in keys}
    sections = configuration_keys(example)
    explained = {f"{section}.{key}" for section, _, groups in sections for _, pairs in groups for key, _ in pairs}
    for what, names in (("explains no", set(allowed) - explained), ("explains", explained - set(allowed))):
        if names:
            raise ValueError(f"the example of the configuration {what} {', '.join(sorted(names))}, expected: what disparityd knows")
    lines = head("disparityd.toml", 5, date, version, "disparityd")
    lines += [".SH NAME", "disparityd.toml \\- configuration of disparityd", ".SH DESCRIPTION"]
    lines += paragraph("The file is TOML. A key that is left out has its default. disparityd --config FILE --check checks a file; "
                       "SIGHUP loads it again, and a file with a mistake changes nothing. disparityd --set section.key=value "
                       "overrides a key.")
    for section, note, groups in sections:
        lines.append(f".SH [{escaped(section)}]")
        if note:
            lines += paragraph(note)
        for comment, pairs in groups:
            for number, (key, value) in enumerate(pairs):
                lines += [".TP" if number == 0 else ".TQ", f"\\fB{escaped(key)}\\fR = {escaped(value)}"]
            lines += paragraph(comment)
            for key, _ in pairs:
                text = ("Allowed" if len(pairs) == 1 else f"{key} allowed") + ": " + allowed[f"{section}.{key}"] + "."
                lines += [".br", *paragraph(text)]
    lines.append(".SH SEE ALSO")
    lines += [f".BR {escaped(name)} ({number})" for name, number in see_also]
    return "\n".join(lines) + "\n"
