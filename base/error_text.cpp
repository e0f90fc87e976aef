// SPDX-License-Identifier: Apache-2.0
// Apart from failure_text(): the Python matcher of tools/wheel has this one, and no OpenCV.
#include <cerrno>
#include <string>
#include <system_error>

#include "base/failure_text.h"

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
