/* Submissions that share a transaction. Whoever comes while another one commits waits for that
 * commit to end; the first of those then writes for all who have come meanwhile. Each is durable
 * when its store_submit returns, and a commit costs the disk the same for one as for many. */
#ifndef PNEULAB_STORE_GROUP_H
#define PNEULAB_STORE_GROUP_H

struct group;

/* NULL without memory. */
struct group *group_create(void);
void group_destroy(struct group *group);

#endif
