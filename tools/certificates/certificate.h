// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include <openssl/evp.h>
#include <openssl/x509.h>

namespace disparityd::tools {

/// What a certificate says.
struct CertificateFacts {
    enum class Purpose { authority, server, client };

    Purpose purpose = Purpose::client;
    std::string common_name{};                                 ///< 1 to 64 bytes
    std::vector<std::string> hosts{};                          ///< of a server: names and addresses
    std::chrono::seconds valid_from{-std::chrono::hours(24)};  ///< counted from now: clocks differ
    std::chrono::seconds valid_to{std::chrono::hours(24)};
};

/// A certificate and its key (ECDSA, P-256).
struct Certificate {
    std::unique_ptr<EVP_PKEY, decltype(&EVP_PKEY_free)> key{nullptr, EVP_PKEY_free};
    std::unique_ptr<X509, decltype(&X509_free)> certificate{nullptr, X509_free};

    /// Return them as PEM.
    std::string key_text() const;
    std::string certificate_text() const;

    /// Returns its last day, "2031-05-07".
    std::string last_day() const;
};

/// Makes a key and a certificate. `authority` signs it; nullptr: its own key does. Throws std::invalid_argument for a
/// name that no certificate can have, std::runtime_error when OpenSSL refuses.
Certificate make_certificate(const CertificateFacts& facts, const Certificate* authority);

/// Reads an authority's certificate and key. Throws std::invalid_argument with one line when they cannot be used.
Certificate read_authority(const std::string& certificate_path, const std::string& key_path);

}  // namespace disparityd::tools
