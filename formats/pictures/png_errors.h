// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <csetjmp>
#include <cstring>

#include <png.h>

namespace disparityd::formats {

/// What libpng complains of: the reader and the writer hand it over as libpng's error_ptr. Errors jump to
/// png_jmpbuf(), so that between setjmp() and the calls of libpng no function may have anything to destroy. Warnings
/// are dropped.
class PngErrors {
public:
    /// What libpng refused.
    const char* why() const { return why_.data(); }

    [[noreturn]] static void refuse(png_structp png, png_const_charp message) {
        auto* const self = static_cast<PngErrors*>(png_get_error_ptr(png));
        std::strncpy(self->why_.data(), message, self->why_.size() - 1);
        std::longjmp(png_jmpbuf(png), 1);
    }
    static void ignore(png_structp /*png*/, png_const_charp /*message*/) {}

private:
    std::array<char, 128> why_{};
};

}  // namespace disparityd::formats
