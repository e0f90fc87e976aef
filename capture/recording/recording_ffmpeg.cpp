// SPDX-License-Identifier: Apache-2.0
#include "capture/recording/recording_ffmpeg.h"

extern "C" {
#include <libavutil/log.h>
}

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdarg>
#include <mutex>

#include "base/failure_text.h"

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

std::string kept_message() {
    std::string message = last_message.data();
    for (char& c : message) {
        if (static_cast<unsigned char>(c) < ' ') {
            c = ' ';
        }
    }
    while (!message.empty() && (message.back() == ' ' || message.back() == '.')) {
        message.pop_back();
    }
    return message;
}

/// FFmpeg's parsers return any number of errno for a file that they do not understand: -1 would be "Operation not
/// permitted", another one "Device or resource busy". Only numbers that they do not misuse are believed.
std::string meaning_of(int error) {
    constexpr std::array believed{EACCES, EDQUOT, EFBIG, EIO, EMFILE, ENFILE, ENOMEM, ENOSPC, EPIPE, EROFS};
    if (std::find(believed.begin(), believed.end(), AVUNERROR(error)) != believed.end()) {
        return base::error_text(AVUNERROR(error));
    }
    if (error == AVERROR_EOF) {
        return "it ends too early";
    }
    constexpr int largest_errno = 4095;  // beyond are FFmpeg's own, whose words are right
    if (error == AVERROR_INVALIDDATA || AVUNERROR(error) <= largest_errno) {
        return "its data are damaged or of an unknown kind";
    }
    std::array<char, AV_ERROR_MAX_STRING_SIZE> words{};
    av_strerror(error, words.data(), words.size());
    return words.data();
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
    const std::string message = kept_message();
    if (message.starts_with("Format not on whitelist")) {
        return "its format is not among those that are read: Matroska, WebM, MP4, AVI, MPEG, Y4M, Ogg, NUT, ASF, FLV";
    }
    const std::string reason = meaning_of(error);
    return message.empty() ? reason : reason + ": " + message;
}

}  // namespace disparityd::capture
