# SPDX-License-Identifier: Apache-2.0
"""Completions for bash, zsh and fish, of a program's options and sub-commands."""
import textwrap

MADE = "# SPDX-License-Identifier: Apache-2.0; made of the program's own options by tools/docs"
# What a shell shows beside an option has one line.
WIDTH = 72


def short(text):
    """Returns the beginning of a description."""
    return textwrap.shorten(text.partition("; ")[0].rstrip("."), WIDTH, placeholder=" ...")


def in_quotes(text):
    """Returns a word for bash and zsh."""
    return "'" + text.replace("'", "'\\''") + "'"


def identifier(name):
    return "_" + name.replace("-", "_")


def takes_key(option):
    """Whether the value begins with a key of the configuration."""
    return option.value.startswith("SECTION.KEY")


# bash

BASH_BODY = """\
    if [[ $folders == *" $previous "* ]]; then
        compopt -o filenames 2>/dev/null
        mapfile -t COMPREPLY < <(compgen -d -- "$current")
    elif [[ $files == *" $previous "* ]]; then
        compopt -o filenames 2>/dev/null
        mapfile -t COMPREPLY < <(compgen -f -- "$current")
    elif [[ $keyed == *" $previous "* ]]; then
        compopt -o nospace 2>/dev/null
        mapfile -t COMPREPLY < <(compgen -W "$keys" -- "$current")
    elif [[ $values == *" $previous "* ]]; then
        return
    elif [[ $current == -* ]]; then
        mapfile -t COMPREPLY < <(compgen -W "$flags" -- "$current")
    elif [[ -n $words ]]; then
        mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
    elif [[ -n $takes_files ]]; then
        compopt -o filenames 2>/dev/null
        mapfile -t COMPREPLY < <(compgen -f -- "$current")
    fi
"""


def _bash_words(command):
    """Returns the variables that say what a command takes."""
    def names(chosen):
        return in_quotes("".join(f" {name}" for option in command.flags() if option.value and chosen(option) for name in option.names)
                         + " ")

    flags = " ".join(name for option in command.flags() for name in option.names)
    takes_files = "yes" if any(option.files() for option in command.positionals()) else ""
    return [f"flags={in_quotes(flags)}",
            f"words={in_quotes(' '.join(sub.name for sub in command.commands))}",
            f"files={names(lambda option: option.files() == 'file')}",
            f"folders={names(lambda option: option.files() == 'folder')}",
            f"keyed={names(takes_key)}",
            f"values={names(lambda option: not option.files() and not takes_key(option))}",
            f"takes_files={takes_files}"]


def bash(program):
    function = identifier(program.name)
    lines = [MADE, "# shellcheck shell=bash", f"{function}() {{",
             "    local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]} command='' index",
             "    local flags words files folders keyed values takes_files keys=" +
             in_quotes(" ".join(key["name"] + "=" for key in program.keys)),
             "    COMPREPLY=()",
             "    # --option=value is three words.",
             "    if [[ $current == = ]]; then",
             "        current=''",
             "    elif [[ $previous == = ]]; then",
             "        previous=${COMP_WORDS[COMP_CWORD - 2]}",
             "    fi"]
    if program.commands:
        names = " | ".join(sub.name for sub in program.commands)
        lines += ["    for ((index = 1; index < COMP_CWORD; index++)); do",
                  "        case ${COMP_WORDS[index]} in",
                  f"            {names}) command=${{COMP_WORDS[index]}} && break ;;",
                  "        esac",
                  "    done"]
    lines.append("    case $command in")
    for pattern, command in [(sub.name, sub) for sub in program.commands] + [("*", program)]:
        lines += [f"        {pattern})", *(f"            {one}" for one in _bash_words(command)), "            ;;"]
    lines += ["    esac", BASH_BODY.rstrip("\n"), "}", f"complete -F {function} {program.name}"]
    return "\n".join(lines) + "\n"


# zsh


def _zsh_text(text):
    return "".join("\\" + character if character in "[]:\\" else character for character in text)


def _zsh_action(option, keys):
    if takes_key(option):
        return "(" + " ".join(key["name"] + "=" for key in keys) + ")"
    return {"file": "_files", "folder": "_files -/"}.get(option.files(), " ")


def _zsh_arguments(command, keys):
    """Returns what _arguments is told of a command, a word per line."""
    specifications = []
    for option in command.flags():
        for name in option.names:
            others = option.names + option.excludes
            text = "*" if option.several else f"({' '.join(others)})" if len(others) > 1 else ""
            text += name + ("=" if option.value and name.startswith("--") else "") + f"[{_zsh_text(short(option.description))}]"
            if option.value:
                text += f":{_zsh_text(option.value)}:{_zsh_action(option, keys)}"
            specifications.append(in_quotes(text))
    for number, option in enumerate(command.positionals(), 1):
        place = "*" if option.several else str(number)
        colon = ":" if option.required or option.several else "::"
        specifications.append(in_quotes(f"{place}{colon}{_zsh_text(option.names[0])}:{_zsh_action(option, keys)}"))
    return specifications


def zsh(program):
    function = identifier(program.name)
    lines = [f"#compdef {program.name}", MADE, f"{function}() {{"]
    arguments = _zsh_arguments(program, program.keys)
    if not program.commands:
        lines.append("    _arguments \\")
        lines += [f"        {word} \\" for word in arguments[:-1]] + [f"        {arguments[-1]}"]
    else:
        lines += ["    local context state line", "    typeset -A opt_args", "    local -a commands=("]
        lines += ["        " + in_quotes(f"{sub.name}:{short(sub.description)}") for sub in program.commands]
        lines += ["    )", "    _arguments -C \\", *(f"        {word} \\" for word in arguments),
                  "        '1:command:->command' '*::argument:->argument' && return",
                  "    case $state in", "        command) _describe -t commands command commands ;;",
                  "        argument)", "            case $words[1] in"]
        for sub in program.commands:
            words = _zsh_arguments(sub, program.keys)
            lines += [f"                {sub.name})", "                    _arguments \\",
                      *(f"                        {word} \\" for word in words[:-1]), f"                        {words[-1]} ;;"]
        lines += ["            esac ;;", "    esac"]
    lines += ["}", f'{function} "$@"']
    return "\n".join(lines) + "\n"


# fish


def _fish_quotes(text):
    return "'" + text.replace("\\", "\\\\").replace("'", "\\'") + "'"


def _fish_options(program, command, condition):
    start = f"complete -c {program.name}" + (f" -n {_fish_quotes(condition)}" if condition else "")
    lines = []
    for option in command.flags():
        names = [f"-l {name[2:]}" if name.startswith("--") else f"-s {name[1:]}" for name in option.names]
        value = ""
        if takes_key(option):
            value = " -x -a " + _fish_quotes(" ".join(key["name"] + "=" for key in program.keys))
        elif option.value:
            value = {"file": " -r -F", "folder": " -x -a '(__fish_complete_directories)'"}.get(option.files(), " -x")
        # One line has one long name.
        short_names, long_names = [n for n in names if n.startswith("-s")], [n for n in names if n.startswith("-l")]
        for number, name in enumerate(long_names or short_names):
            together = " ".join(([*short_names] if number == 0 and long_names else []) + [name])
            lines.append(f"{start} {together}{value} -d {_fish_quotes(short(option.description))}")
    if any(option.files() for option in command.positionals()):
        lines.append(f"{start} -F")
    return lines


def fish(program):
    lines = [MADE, f"complete -c {program.name} -f"]
    if not program.commands:
        return "\n".join(lines + _fish_options(program, program, "")) + "\n"
    lines += _fish_options(program, program, "__fish_use_subcommand")
    for sub in program.commands:
        lines.append(f"complete -c {program.name} -n __fish_use_subcommand -a {sub.name} -d {_fish_quotes(short(sub.description))}")
        lines += _fish_options(program, sub, f"__fish_seen_subcommand_from {sub.name}")
    return "\n".join(lines) + "\n"
