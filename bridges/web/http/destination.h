// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string_view>

#include "bridges/web/http/routes.h"
#include "bridges/web/live/live_session.h"

namespace disparityd::web {

/// Which of the server's daemons a request is about.
struct Destination {
    const Workplace* place = nullptr;  ///< nullptr: no daemon, or one that is not known
    Handler* handler = nullptr;
    std::size_t prefix = 0;  ///< so many bytes of the path said which; the rest is as of a server of that daemon alone
};

/// The daemons of a server. The network's thread owns it.
class ServedDaemons {
public:
    virtual ~ServedDaemons() = default;
    virtual Destination destination(std::string_view path) = 0;
    /// Tells all threads to end, and does not wait for them.
    virtual void stop() = 0;
};

}  // namespace disparityd::web
