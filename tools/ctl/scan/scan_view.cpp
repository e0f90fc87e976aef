// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/scan/scan_view.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <climits>
#include <clocale>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <langinfo.h>
#include <locale.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tools/command_line/interrupt.h"
#include "tools/command_line/table.h"
#include "tools/ctl/scan/radar.h"

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

/// Writes lines to standard output for a program that reads them through a pipe. A pipe holds 64 KiB, so that a program
/// that works on each scan would read those of seconds ago: the next one is written when the last one was read.
class ScanLines {
public:
    ScanLines();

    /// Waits until all that was written has been read, `longest` at most, and returns whether it has. What is no pipe
    /// keeps nobody waiting.
    bool read(std::chrono::milliseconds longest) const;

    /// Writes a line. Ctrl-C ends the wait for room in a pipe, and what is left of the line is not written then. Throws
    /// std::runtime_error when it cannot be written.
    void put(const std::string& line);

private:
    bool pipe_ = false;
};

[[noreturn]] void fail() {
    throw std::runtime_error("standard output cannot be written");
}

/// Waits until PIPE_BUF bytes can be written, or the reader is gone. Returns false when Ctrl-C came first.
bool wait_for_room() {
    pollfd output{STDOUT_FILENO, POLLOUT, 0};
    while (::poll(&output, 1, 100) <= 0) {
        if (interrupted()) {
            return false;
        }
    }
    return true;
}

bool reader_is_gone() {
    pollfd output{STDOUT_FILENO, 0, 0};
    return ::poll(&output, 1, 0) > 0 && (output.revents & POLLERR) != 0;
}

ScanLines::ScanLines() {
    struct stat output {};
    pipe_ = ::fstat(STDOUT_FILENO, &output) == 0 && S_ISFIFO(output.st_mode);
}

bool ScanLines::read(std::chrono::milliseconds longest) const {
    const auto end = std::chrono::steady_clock::now() + longest;
    while (pipe_) {
        int unread = 0;
        if (::ioctl(STDOUT_FILENO, FIONREAD, &unread) != 0 || unread == 0 || reader_is_gone()) {
            return true;  // put() finds out what is wrong
        }
        if (interrupted() || std::chrono::steady_clock::now() >= end) {
            return false;
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(2));  // nothing says when a pipe has been read
    }
    return true;
}

void ScanLines::put(const std::string& line) {
    if (!pipe_) {
        std::cout << line << std::endl;
        if (!std::cout) {
            fail();
        }
        return;
    }
    const std::string text = line + '\n';
    for (std::string_view rest = text; !rest.empty();) {
        if (!wait_for_room()) {
            return;
        }
        const ssize_t written = ::write(STDOUT_FILENO, rest.data(), std::min<std::size_t>(rest.size(), PIPE_BUF));
        if (written < 0 && errno != EINTR && errno != EAGAIN) {
            fail();
        }
        rest.remove_prefix(static_cast<std::size_t>(std::max<ssize_t>(written, 0)));
    }
}

class LinesView : public ScanView {
public:
    bool taken(std::chrono::milliseconds longest) override { return lines_.read(longest); }

protected:
    void put(const std::string& line) { lines_.put(line); }

private:
    ScanLines lines_;
};

class JsonScanView final : public LinesView {
public:
    void show(const ScanReading& reading) override { put(to_text(scan_json(reading), -1)); }
    void show_none(const std::string& why, double /*silent_s*/) override { put(to_text(no_scan_json(why), -1)); }
};

class LineScanView final : public LinesView {
public:
    LineScanView() { put(scan_heading()); }
    void show(const ScanReading& reading) override { put(scan_line(reading)); }
    void show_none(const std::string& why, double /*silent_s*/) override { put(no_scan_line(why)); }
};

/// Draws the newest scan. While none comes, the plot shows its sectors as unknown: an old scan says nothing of now.
class RadarScanView final : public ScanView {
public:
    explicit RadarScanView(const RadarChoice& choice)
        : ascii_(choice.ascii || !screen_.utf8()), fixed_range_m_(choice.range_m) {}

    void show(const ScanReading& reading) override {
        hidden_ = false;
        last_ = reading.scan;
        range_m_ = std::max(range_m_, fitting_range(last_));  // grows only: a scale that jumps cannot be read
        draw(scan_parts(reading), last_);
    }

    void hide(double silent_s) override {
        if (!hidden_) {
            show_none("asking the daemon why", silent_s);
        }
    }

    void show_none(const std::string& why, double silent_s) override {
        hidden_ = true;
        draw({"NO SCAN for " + fixed(silent_s, 0) + " s, so nothing is known", why}, all_unknown(last_));
    }

private:
    void draw(const std::vector<std::string>& parts, const disparity::Scan& scan) {
        std::vector<std::string> lines = wrapped(parts, screen_.columns() - 1);
        lines.resize(std::max<std::size_t>(lines.size(), 2));  // so that the plot stays where it is
        RadarStyle style;
        style.columns = screen_.columns() - 1;
        style.rows = screen_.rows() - 1 - static_cast<int>(lines.size());
        style.range_m = fixed_range_m_.value_or(range_m_);
        style.ascii = ascii_;
        const auto plot = radar_lines(draw_radar(scan, style), screen_.colour());
        lines.insert(lines.end(), plot.begin(), plot.end());
        screen_.show(lines);
    }

    LiveScreen screen_;
    bool ascii_;
    std::optional<double> fixed_range_m_;
    bool hidden_ = false;
    double range_m_ = 1;
    disparity::Scan last_;
};

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

std::unique_ptr<ScanView> json_scan_view() {
    return std::make_unique<JsonScanView>();
}

std::unique_ptr<ScanView> line_scan_view() {
    return std::make_unique<LineScanView>();
}

std::unique_ptr<ScanView> radar_scan_view(const RadarChoice& choice) {
    return std::make_unique<RadarScanView>(choice);
}

}  // namespace disparityd::tools
