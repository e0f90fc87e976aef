// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/scan/live_screen.h"

#include <clocale>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string_view>

#include <langinfo.h>
#include <locale.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace disparityd::tools {
namespace {

std::string_view environment(const char* name) {
    const char* const value = std::getenv(name);
    return value == nullptr ? std::string_view() : std::string_view(value);
}

/// Returns the size of the terminal; 0 x 0 where it is not known.
winsize terminal_size() {
    winsize size{};
    if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0) {
        size = {};
    }
    return size;
}

}  // namespace

LiveScreen::LiveScreen()
    : in_place_(isatty(STDOUT_FILENO) != 0 && !environment("TERM").empty() && environment("TERM") != "dumb") {}

bool LiveScreen::colour() const {
    return in_place_ && environment("NO_COLOR").empty();
}

bool LiveScreen::utf8() const {
    const locale_t locale = ::newlocale(LC_CTYPE_MASK, "", nullptr);
    if (locale == nullptr) {
        return false;
    }
    const bool utf8 = std::string_view(::nl_langinfo_l(CODESET, locale)) == "UTF-8";
    ::freelocale(locale);
    return utf8;
}

int LiveScreen::columns() const {
    const int columns = terminal_size().ws_col;
    return columns > 0 ? columns : 80;
}

int LiveScreen::rows() const {
    const int rows = terminal_size().ws_row;
    return rows > 0 ? rows : 24;
}

void LiveScreen::show(const std::vector<std::string>& lines) {
    std::string text;
    if (in_place_) {
        text = cleared_ ? "\033[H" : "\033[2J\033[H";
        cleared_ = true;
    }
    for (const std::string& line : lines) {
        text += line + (in_place_ ? "\033[K\n" : "\n");
    }
    text += in_place_ ? "\033[J" : "\n";
    // Not by std::cout, which takes control characters out.
    if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) {
        throw std::runtime_error("standard output cannot be written");
    }
}

}  // namespace disparityd::tools
