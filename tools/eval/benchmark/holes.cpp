// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/benchmark/holes.h"

namespace disparityd::eval {

std::string_view name(Holes holes) {
    switch (holes) {
        case Holes::bad: return "bad";
        case Holes::left_out: return "left-out";
        case Holes::filled: return "filled";
    }
    return "";
}

}  // namespace disparityd::eval
