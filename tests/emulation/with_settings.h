// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/emulation/runtime_api.h"
#include "tests/emulation/simt.h"

namespace disparityd::test {

/// These settings of the emulation for a scope, then those from before.
class WithSettings {
public:
    explicit WithSettings(const simt::Settings& settings) : before_(simt::settings()) { simt::settings() = settings; }
    ~WithSettings() { simt::settings() = before_; }
    WithSettings(const WithSettings&) = delete;
    WithSettings& operator=(const WithSettings&) = delete;

private:
    simt::Settings before_;
};

/// This machine for a scope, then the one from before.
class WithMachine {
public:
    explicit WithMachine(const simt::Machine& machine) : before_(simt::machine()) { simt::machine() = machine; }
    ~WithMachine() { simt::machine() = before_; }
    WithMachine(const WithMachine&) = delete;
    WithMachine& operator=(const WithMachine&) = delete;

private:
    simt::Machine before_;
};

}  // namespace disparityd::test
