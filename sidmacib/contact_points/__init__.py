"""SiDMACIB: limit analysis of a joint on a few contact points per lock."""
