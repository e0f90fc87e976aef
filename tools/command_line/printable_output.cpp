// SPDX-License-Identifier: Apache-2.0
#include "tools/command_line/printable_output.h"

namespace disparityd::tools {
namespace {

constexpr unsigned char lead = 0xc2;  // of U+0080 to U+00BF

}  // namespace

PrintableOutput::~PrintableOutput() {
    PrintableOutput::sync();
    stream_.rdbuf(target_);
}

std::streamsize PrintableOutput::xsputn(const char* bytes, std::streamsize count) {
    std::string clean;
    clean.reserve(static_cast<std::size_t>(count) + 1);
    for (std::streamsize i = 0; i < count; ++i) {
        const auto byte = static_cast<unsigned char>(bytes[i]);
        if (held_back_) {
            held_back_ = false;
            const bool control = byte >= 0x80 && byte < 0xa0;
            clean += control ? '?' : static_cast<char>(lead);
            if (control) {
                clean += '?';
                continue;
            }
        }
        if (byte == lead) {
            held_back_ = true;
        } else if ((byte < 0x20 && byte != '\n' && byte != '\t') || byte == 0x7f) {
            clean += '?';
        } else {
            clean += bytes[i];
        }
    }
    const auto size = static_cast<std::streamsize>(clean.size());
    return target_->sputn(clean.data(), size) == size ? count : 0;
}

PrintableOutput::int_type PrintableOutput::overflow(int_type character) {
    if (traits_type::eq_int_type(character, traits_type::eof())) {
        return traits_type::not_eof(character);
    }
    const char byte = traits_type::to_char_type(character);
    return xsputn(&byte, 1) == 1 ? character : traits_type::eof();
}

int PrintableOutput::sync() {
    if (held_back_) {
        held_back_ = false;
        if (traits_type::eq_int_type(target_->sputc(static_cast<char>(lead)), traits_type::eof())) {
            return -1;
        }
    }
    return target_->pubsync();
}

}  // namespace disparityd::tools
