// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/http/unacknowledged.h"

#include <linux/sockios.h>
#include <sys/ioctl.h>

namespace disparityd::web {

std::size_t unacknowledged_bytes(int descriptor) {
    int bytes = 0;
    return ::ioctl(descriptor, SIOCOUTQ, &bytes) == 0 && bytes > 0 ? static_cast<std::size_t>(bytes) : 0;
}

}  // namespace disparityd::web
