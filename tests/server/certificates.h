// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509v3.h>

#include "tests/support/test.h"

namespace kerf::test {

inline constexpr long kDayS = 86'400;

/// Validity, names and key password of a self-signed certificate.
struct Certified {
  long begins_s = -kDayS, ends_s = kDayS;  ///< from now on
  const char* names = "DNS:localhost,IP:127.0.0.1";
  const char* password = nullptr;  ///< of the key
};

/// Writes a self-signed certificate to PATH.pem and its key to PATH.key.
inline void certify(const std::filesystem::path& path, const Certified& words = {}) {
  const std::unique_ptr<EVP_PKEY, decltype(&EVP_PKEY_free)> key(EVP_EC_gen("P-256"), EVP_PKEY_free);
  const std::unique_ptr<X509, decltype(&X509_free)> own(X509_new(), X509_free);
  ASSERT_TRUE(key && own);
  X509_set_version(own.get(), X509_VERSION_3);
  ASN1_INTEGER_set(X509_get_serialNumber(own.get()), 1);
  X509_gmtime_adj(X509_getm_notBefore(own.get()), words.begins_s);
  X509_gmtime_adj(X509_getm_notAfter(own.get()), words.ends_s);
  X509_set_pubkey(own.get(), key.get());
  X509_NAME* name = X509_get_subject_name(own.get());
  const std::string text = path.filename();
  X509_NAME_add_entry_by_txt(name, "CN", MBSTRING_ASC,
                             reinterpret_cast<const unsigned char*>(text.c_str()), -1, -1, 0);
  X509_set_issuer_name(own.get(), name);
  const std::unique_ptr<X509_EXTENSION, decltype(&X509_EXTENSION_free)> names(
      X509V3_EXT_conf_nid(nullptr, nullptr, NID_subject_alt_name, words.names),
      X509_EXTENSION_free);
  ASSERT_EQ(X509_add_ext(own.get(), names.get(), -1), 1);
  ASSERT_GT(X509_sign(own.get(), key.get(), EVP_sha256()), 0);
  const auto write = [&](const char* extension, auto&& put) {
    const std::unique_ptr<FILE, int (*)(FILE*)> file(
        std::fopen((path.string() + extension).c_str(), "w"), std::fclose);
    ASSERT_TRUE(file);
    EXPECT_EQ(put(file.get()), 1);
  };
  write(".pem", [&](FILE* file) { return PEM_write_X509(file, own.get()); });
  write(".key", [&](FILE* file) {
    const EVP_CIPHER* cipher = words.password == nullptr ? nullptr : EVP_aes_128_cbc();
    return PEM_write_PrivateKey(file, key.get(), cipher, nullptr, 0, nullptr,
                                const_cast<char*>(words.password));
  });
}

}  // namespace kerf::test
