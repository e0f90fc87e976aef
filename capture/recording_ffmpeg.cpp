// SPDX-License-Identifier: Apache-2.0
#include "capture/recording_ffmpeg.h"

extern "C" {
#include <libavutil/log.h>
}

#include <array>
#include <cstdarg>
#include <mutex>

namespace disparityd::capture {
namespace {

thread_local std::array<char, 256> last_message{};

void keep_message(void* context, int level, const char* format, va_list arguments) {
    if (level <= AV_LOG_ERROR) {
        int print_prefix = 0;  // the prefix is an address, which tells a user nothing
        av_log_format_line2(context, level, format, arguments, last_message.data(),
                            static_cast<int>(last_message.size()), &print_prefix);
    }
}

}  // namespace

void keep_ffmpeg_log() {
    static std::once_flag once;
    std::call_once(once, [] { av_log_set_callback(keep_message); });
}

void clear_ffmpeg_log() noexcept {
    last_message[0] = '\0';
}

std::string ffmpeg_reason(int error) {
    std::array<char, AV_ERROR_MAX_STRING_SIZE> meaning{};
    av_strerror(error, meaning.data(), meaning.size());
    std::string reason = meaning.data();
    std::string message = last_message.data();
    for (char& c : message) {
        if (static_cast<unsigned char>(c) < ' ') {
            c = ' ';
        }
    }
    while (!message.empty() && (message.back() == ' ' || message.back() == '.')) {
        message.pop_back();
    }
    if (!message.empty()) {
        reason += ": " + message;
    }
    return reason;
}

}  // namespace disparityd::capture
