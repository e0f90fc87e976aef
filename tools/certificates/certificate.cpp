// SPDX-License-Identifier: Apache-2.0
#include "tools/certificates/certificate.h"

#include <array>
#include <ctime>
#include <stdexcept>

#include <openssl/bn.h>
#include <openssl/err.h>
#include <openssl/x509v3.h>

#include "proto/tls/tls_context.h"
#include "tools/certificates/pem.h"

namespace disparityd::tools {
namespace {

using Purpose = CertificateFacts::Purpose;

/// Returns "DNS:robot.local" or "IP:192.168.1.5". No comma can stand in either, so that a name adds no others.
std::string alternative_name(const std::string& host) {
    if (proto::is_address(host)) {
        return "IP:" + host;
    }
    constexpr const char* allowed = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-._*";
    if (host.empty() || host.size() > 253 || host.find_first_not_of(allowed) != std::string::npos) {
        throw std::invalid_argument("found the host \"" + host +
                                    "\", allowed: a name such as robot.local, or an address");
    }
    return "DNS:" + host;
}

void add_extension(X509* certificate, X509* issuer, int kind, const std::string& value) {
    X509V3_CTX context{};
    X509V3_set_ctx(&context, issuer, certificate, nullptr, nullptr, 0);
    const std::unique_ptr<X509_EXTENSION, decltype(&X509_EXTENSION_free)> extension(
        X509V3_EXT_conf_nid(nullptr, &context, kind, value.c_str()), X509_EXTENSION_free);
    check_openssl(extension && X509_add_ext(certificate, extension.get(), -1) == 1, value.c_str());
}

void add_extensions(X509* certificate, X509* issuer, const CertificateFacts& facts) {
    const bool authority = facts.purpose == Purpose::authority;
    add_extension(certificate, issuer, NID_basic_constraints,
                  authority ? "critical,CA:TRUE,pathlen:0" : "critical,CA:FALSE");
    add_extension(certificate, issuer, NID_key_usage,
                  authority ? "critical,keyCertSign,cRLSign" : "critical,digitalSignature");
    add_extension(certificate, issuer, NID_subject_key_identifier, "hash");
    if (authority) {
        return;
    }
    add_extension(certificate, issuer, NID_authority_key_identifier, "keyid");
    add_extension(certificate, issuer, NID_ext_key_usage,
                  facts.purpose == Purpose::server ? "serverAuth" : "clientAuth");
    std::string names;
    for (const std::string& host : facts.hosts) {
        names += (names.empty() ? "" : ",") + alternative_name(host);
    }
    if (!names.empty()) {
        add_extension(certificate, issuer, NID_subject_alt_name, names);
    }
}

void set_serial(X509* certificate) {
    constexpr int bits = 127;
    const std::unique_ptr<BIGNUM, decltype(&BN_free)> number(BN_new(), BN_free);
    check_openssl(number && BN_rand(number.get(), bits, BN_RAND_TOP_ONE, BN_RAND_BOTTOM_ANY) == 1 &&
                      BN_to_ASN1_INTEGER(number.get(), X509_get_serialNumber(certificate)) != nullptr,
                  "a serial number");
}

void set_subject(X509* certificate, const std::string& common_name) {
    constexpr std::size_t longest = 64;
    if (common_name.empty() || common_name.size() > longest || common_name.find('\0') != std::string::npos) {
        throw std::invalid_argument("found the name \"" + common_name + "\", allowed: 1 to 64 bytes");
    }
    check_openssl(X509_NAME_add_entry_by_NID(X509_get_subject_name(certificate), NID_commonName, MBSTRING_UTF8,
                                             reinterpret_cast<const unsigned char*>(common_name.data()),
                                             static_cast<int>(common_name.size()), -1, 0) == 1,
                  "a name");
}

}  // namespace

std::string Certificate::key_text() const {
    return pem_text(
        [this](BIO* bio) { return PEM_write_bio_PrivateKey(bio, key.get(), nullptr, nullptr, 0, nullptr, nullptr); });
}

std::string Certificate::certificate_text() const {
    return pem_text([this](BIO* bio) { return PEM_write_bio_X509(bio, certificate.get()); });
}

std::string Certificate::last_day() const {
    std::tm end{};
    check_openssl(ASN1_TIME_to_tm(X509_get0_notAfter(certificate.get()), &end) == 1, "its last day");
    std::array<char, 16> text{};
    return {text.data(), std::strftime(text.data(), text.size(), "%Y-%m-%d", &end)};
}

Certificate make_certificate(const CertificateFacts& facts, const Certificate* authority) {
    ERR_clear_error();
    Certificate made;
    made.key.reset(EVP_EC_gen("P-256"));
    made.certificate.reset(X509_new());
    X509* const certificate = made.certificate.get();
    check_openssl(made.key && made.certificate, "a key");
    const Certificate& issuer = authority == nullptr ? made : *authority;
    set_serial(certificate);
    set_subject(certificate, facts.common_name);
    check_openssl(X509_set_version(certificate, X509_VERSION_3) == 1 &&
                      X509_set_pubkey(certificate, made.key.get()) == 1 &&
                      X509_set_issuer_name(certificate, X509_get_subject_name(issuer.certificate.get())) == 1 &&
                      X509_gmtime_adj(X509_getm_notBefore(certificate), facts.valid_from.count()) != nullptr &&
                      X509_gmtime_adj(X509_getm_notAfter(certificate), facts.valid_to.count()) != nullptr,
                  "its fields");
    add_extensions(certificate, issuer.certificate.get(), facts);
    check_openssl(X509_sign(certificate, issuer.key.get(), EVP_sha256()) > 0, "a signature");
    return made;
}

Certificate read_authority(const std::string& certificate_path, const std::string& key_path) {
    ERR_clear_error();
    Certificate authority;
    authority.certificate.reset(read_pem<X509>(certificate_path, PEM_read_X509));
    authority.key.reset(read_pem<EVP_PKEY>(key_path, PEM_read_PrivateKey));
    if (X509_check_private_key(authority.certificate.get(), authority.key.get()) != 1) {
        throw std::invalid_argument(key_path + ": is not the key of " + certificate_path + ": " +
                                    proto::take_tls_error());
    }
    return authority;
}

}  // namespace disparityd::tools
