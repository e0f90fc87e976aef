// SPDX-License-Identifier: Apache-2.0
#include "daemon/build_reason.h"

namespace disparityd::daemon {

FailureAction after_failed_build(BuildReason reason) {
    switch (reason) {
        case BuildReason::start: return FailureAction::end_daemon;
        case BuildReason::reload: return FailureAction::refuse_reload;
        case BuildReason::source_changed: return FailureAction::keep_source;
        case BuildReason::rollback: break;
    }
    return FailureAction::wait_for_reload;
}

FailureAction after_failed_take_over(BuildReason reason, EngineInUse in_use) {
    switch (in_use) {
        case EngineInUse::none: return FailureAction::end_daemon;
        case EngineInUse::running: return FailureAction::refuse_reload;
        case EngineInUse::stopped: break;
    }
    return reason == BuildReason::rollback ? FailureAction::wait_for_reload : FailureAction::roll_back;
}

}  // namespace disparityd::daemon
