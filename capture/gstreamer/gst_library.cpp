// SPDX-License-Identifier: Apache-2.0
#include "capture/gstreamer/gst_library.h"

#include <algorithm>
#include <mutex>
#include <stdexcept>
#include <string_view>

#include "base/message_text.h"
#include "base/start_thread.h"
#include "capture/shown_source.h"

namespace disparityd::capture {
namespace {

std::mutex warning_mutex;
std::string& kept_warning() {
    static auto* const kept = new std::string();  // plugins may complain while the program ends
    return *kept;
}

constexpr std::size_t longest_part = 300;

void keep_warning(const gchar*, GLogLevelFlags level, const gchar* message, gpointer) {
    if ((level & G_LOG_LEVEL_MASK) <= G_LOG_LEVEL_WARNING && message != nullptr) {
        const std::lock_guard lock(warning_mutex);
        kept_warning() = without_passwords(base::printable(message, longest_part));
    }
}

/// Leaves out where in GStreamer's source a message was made.
std::string_view behind_the_place(std::string_view debug) {
    const auto line = debug.find('\n');
    return line == std::string_view::npos ? std::string_view() : debug.substr(line + 1);
}

std::string without_dots(std::string_view text) {
    std::string line = base::printable(text, longest_part);
    while (!line.empty() && (line.back() == '.' || line.back() == ' ' || line.back() == '?')) {
        line.pop_back();
    }
    return line;
}

}  // namespace

void start_gstreamer() {
    static std::once_flag once;
    static std::string problem;
    std::call_once(once, [] {
        const base::SignalsBlocked inherited;
        g_log_set_default_handler(keep_warning, nullptr);
        g_set_print_handler([](const gchar*) {});
        GError* error = nullptr;
        if (gst_init_check(nullptr, nullptr, &error) == FALSE) {
            const GstPtr<GError> owned(error);
            problem = error != nullptr ? without_dots(error->message) : std::string("no reason is given");
        }
    });
    if (!problem.empty()) {
        throw std::runtime_error("source gst: GStreamer does not start: " + problem);
    }
}

std::string last_gst_warning() {
    const std::lock_guard lock(warning_mutex);
    return kept_warning();
}

void forget_gst_warning() {
    const std::lock_guard lock(warning_mutex);
    kept_warning().clear();
}

std::string gst_words(GstMessage* message, const GError& error, const gchar* debug) {
    const gchar* const name = message->src != nullptr ? GST_OBJECT_NAME(message->src) : "pipeline";
    std::string line = base::printable(name) + ": " + without_dots(error.message);
    const std::string more = without_dots(behind_the_place(debug != nullptr ? debug : ""));
    return without_passwords(more.empty() ? line : line + " (" + more + ")");
}

std::string caps_text(const GstCaps* caps) {
    const GstPtr<gchar> text(gst_caps_to_string(caps));
    constexpr std::size_t longest = 200;
    return base::printable(text.get(), longest);
}

}  // namespace disparityd::capture
