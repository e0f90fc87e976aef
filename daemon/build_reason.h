// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace disparityd::daemon {

/// Why an engine is built.
enum class BuildReason : unsigned char {
    start,           ///< it is the first
    reload,          ///< the configuration was loaded again
    source_changed,  ///< the source changed; the configuration stays
    rollback,        ///< a new configuration failed after the old engine had ended: the old configuration comes back
};

/// What the daemon does when an engine cannot be built or cannot take over.
enum class FailureAction : unsigned char {
    end_daemon,       ///< nothing has ever run: the program ends with the failure
    refuse_reload,    ///< the engine in use goes on, the new configuration is refused
    keep_source,      ///< the engine in use goes on; the daemon opens the source again later
    roll_back,        ///< no engine runs, the new configuration is refused: the configuration before is built again
    wait_for_reload,  ///< no engine runs, the configuration before failed too: the user has to reload
};

/// The action when an engine could not be built.
FailureAction after_failed_build(BuildReason reason);

/// Whether the engine in use still runs.
enum class EngineInUse : unsigned char { none, running, stopped };

/// The action when an engine was built but could not take over from the engine in use.
FailureAction after_failed_take_over(BuildReason reason, EngineInUse in_use);

}  // namespace disparityd::daemon
