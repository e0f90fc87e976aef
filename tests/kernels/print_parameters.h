// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ostream>

#include "kernels/cpu/backend.h"
#include "kernels/options.h"
#include "kernels/raw_image.h"

// What ctest lists and what a failure shows of a test's parameter; found by GoogleTest in the namespaces of the types.

namespace disparityd {

inline void PrintTo(Method method, std::ostream* out) {
    *out << to_string(method);
}

inline void PrintTo(PixelFormat format, std::ostream* out) {
    switch (format) {
        case PixelFormat::grey8: *out << "grey8"; break;
        case PixelFormat::yuyv: *out << "yuyv"; break;
        case PixelFormat::bgr24: *out << "bgr24"; break;
    }
}

}  // namespace disparityd

namespace disparityd::cpu {

inline void PrintTo(const InstructionSet& set, std::ostream* out) {
    *out << set.name;
}

}  // namespace disparityd::cpu
