/* The certificate that the daemon shows, and its replacement while it runs. */
#ifndef PNEULAB_HTTP_TLS_H
#define PNEULAB_HTTP_TLS_H

#include <gnutls/abstract.h>
#include <gnutls/gnutls.h>

#include "solver/base/error.h"

struct tls;

/* TLS 1.2 and 1.3, with the ciphers that GnuTLS takes for safe. */
#define TLS_PRIORITIES "NORMAL:-VERS-ALL:+VERS-TLS1.3:+VERS-TLS1.2"

/* Reads a PEM chain and the key that belongs to its first certificate; links are followed. The
 * names of the files must outlive *tls, which is the caller's. STATUS_INVALID with the file and the
 * reason. */
enum status tls_create(const char *certificate_file, const char *key_file, struct tls **tls,
                       struct error *error);
void tls_destroy(struct tls *tls);

/* Reads the files again; from then on new connections get what is in them. When that fails, the
 * old certificate stays. Any thread. */
enum status tls_reload(struct tls *tls, struct error *error);

/* For GnuTLS during a handshake: copies of the present chain and key, which GnuTLS frees. The
 * certificate is that of connection_tls() for the session's connection. */
int tls_retrieve(gnutls_session_t session, const struct gnutls_cert_retr_st *info,
                 gnutls_pcert_st **chain, unsigned *chain_length, gnutls_ocsp_data_st **ocsp,
                 unsigned *ocsp_length, gnutls_privkey_t *key, unsigned *flags);

#endif
