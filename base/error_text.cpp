// SPDX-License-Identifier: Apache-2.0
#include "base/error_text.h"

#include <cerrno>
#include <system_error>

namespace disparityd::base {

std::string error_text(int code) {
    switch (code) {
        case EMFILE:
            return "this program has too many files open: raise its limit (ulimit -n, or LimitNOFILE= of a service)";
        case ENFILE: return "all programs together have too many files open: raise the limit (sysctl fs.file-max)";
        case ENOMEM: return "there is not enough memory";
        default: return std::generic_category().message(code);
    }
}

}  // namespace disparityd::base
