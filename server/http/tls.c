#include "server/http/tls.h"

#include <microhttpd.h>
#include <pthread.h>
#include <stdlib.h>
#include <sys/stat.h>

#include "server/base/log.h"
#include "server/http/connections.h"

enum { CHAIN_MAX = 16 };

struct tls {
  const char *certificate_file, *key_file;
  pthread_mutex_t mutex; /* guards what follows */
  gnutls_datum_t certificate, key;
};

static void pair_free(gnutls_datum_t *certificate, gnutls_datum_t *key) {
  if (key->data) {
    gnutls_memset(key->data, 0, key->size);
  }
  gnutls_free(certificate->data);
  gnutls_free(key->data);
  certificate->data = key->data = NULL;
}

/* Whether the texts are a chain and the key of its first certificate: GnuTLS's verdict. */
static int pair_check(const gnutls_datum_t *certificate, const gnutls_datum_t *key) {
  gnutls_certificate_credentials_t credentials;
  int code = gnutls_certificate_allocate_credentials(&credentials);
  if (code == GNUTLS_E_SUCCESS) {
    code = gnutls_certificate_set_x509_key_mem(credentials, certificate, key, GNUTLS_X509_FMT_PEM);
    gnutls_certificate_free_credentials(credentials);
  }
  return code < 0 ? code : GNUTLS_E_SUCCESS;
}

static enum status pair_read(const struct tls *tls, gnutls_datum_t *certificate,
                             gnutls_datum_t *key, struct error *error) {
  const char *file = tls->certificate_file;
  struct stat info;
  int code = gnutls_load_file(file, certificate);
  if (code >= 0) {
    file = tls->key_file;
    code = gnutls_load_file(file, key);
  }
  if (code >= 0) {
    file = tls->certificate_file;
    code = pair_check(certificate, key);
  }
  if (code < 0) {
    pair_free(certificate, key);
    return error_set(error, STATUS_INVALID, NULL,
                     "%s: %s Expected a chain in PEM with --tls-certificate, and with --tls-key "
                     "the key of its first certificate.",
                     file, gnutls_strerror(code));
  }
  if (stat(tls->key_file, &info) == 0 && (info.st_mode & S_IRWXO) != 0) {
    log_line("%s: everybody on this machine may read this key; chmod o= %s", tls->key_file,
             tls->key_file);
  }
  return STATUS_OK;
}

enum status tls_reload(struct tls *tls, struct error *error) {
  gnutls_datum_t certificate = {NULL, 0}, key = {NULL, 0};
  enum status status = pair_read(tls, &certificate, &key, error);
  if (status == STATUS_OK) {
    pthread_mutex_lock(&tls->mutex);
    gnutls_datum_t old_certificate = tls->certificate, old_key = tls->key;
    tls->certificate = certificate;
    tls->key = key;
    pthread_mutex_unlock(&tls->mutex);
    pair_free(&old_certificate, &old_key);
  }
  return status;
}

enum status tls_create(const char *certificate_file, const char *key_file, struct tls **tls,
                       struct error *error) {
  struct tls *made = calloc(1, sizeof *made);
  if (!made) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for the certificate.");
  }
  made->certificate_file = certificate_file;
  made->key_file = key_file;
  pthread_mutex_init(&made->mutex, NULL);
  enum status status = tls_reload(made, error);
  if (status != STATUS_OK) {
    tls_destroy(made);
    return status;
  }
  *tls = made;
  return STATUS_OK;
}

void tls_destroy(struct tls *tls) {
  if (tls) {
    pair_free(&tls->certificate, &tls->key);
    pthread_mutex_destroy(&tls->mutex);
    free(tls);
  }
}

/* Copies of the chain and the key as GnuTLS wants them. */
static int pair_import(const struct tls *tls, gnutls_pcert_st **chain, unsigned *chain_length,
                       gnutls_privkey_t *key) {
  *chain_length = CHAIN_MAX;
  *key = NULL;
  *chain = gnutls_calloc(CHAIN_MAX, sizeof **chain);
  if (!*chain) {
    return GNUTLS_E_MEMORY_ERROR;
  }
  int code = gnutls_pcert_list_import_x509_raw(*chain, chain_length, &tls->certificate,
                                               GNUTLS_X509_FMT_PEM, 0);
  if (code < 0) {
    gnutls_free(*chain);
    return code;
  }
  code = gnutls_privkey_init(key);
  if (code >= 0) {
    code = gnutls_privkey_import_x509_raw(*key, &tls->key, GNUTLS_X509_FMT_PEM, NULL, 0);
  }
  if (code < 0) {
    for (unsigned i = 0; i < *chain_length; i++) {
      gnutls_pcert_deinit(&(*chain)[i]);
    }
    gnutls_free(*chain);
    gnutls_privkey_deinit(*key);
  }
  return code;
}

int tls_retrieve(gnutls_session_t session, const struct gnutls_cert_retr_st *info,
                 gnutls_pcert_st **chain, unsigned *chain_length, gnutls_ocsp_data_st **ocsp,
                 unsigned *ocsp_length, gnutls_privkey_t *key, unsigned *flags) {
  (void)info;
  /* libmicrohttpd keeps its connection in the session, and our own note in the connection. */
  struct MHD_Connection *connection = gnutls_session_get_ptr(session);
  const union MHD_ConnectionInfo *note =
      connection ? MHD_get_connection_info(connection, MHD_CONNECTION_INFO_SOCKET_CONTEXT) : NULL;
  struct tls *tls = note ? connection_tls(note->socket_context) : NULL;
  if (!tls) {
    return -1;
  }
  *ocsp = NULL;
  *ocsp_length = 0;
  *flags = GNUTLS_CERT_RETR_DEINIT_ALL;
  pthread_mutex_lock(&tls->mutex);
  int code = pair_import(tls, chain, chain_length, key);
  pthread_mutex_unlock(&tls->mutex);
  return code < 0 ? -1 : 0;
}
