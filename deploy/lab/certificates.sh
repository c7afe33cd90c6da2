#!/usr/bin/env bash
# certificates.sh FOLDER NAME [ADDRESS]: a certificate for one machine, signed by the lab itself.
#
# NAME is how others call the machine (desk.lab.example), or an actor (actor-1); ADDRESS, an IP
# address by which it is called, too. The first call makes the lab's authority (ca.pem, ca.key).
set -euo pipefail

folder=${1:?which folder?} name=${2:?for whom?} address=${3:-}
key=(-newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes)
umask 077 # Keys are for whoever runs the services, and nobody else.
mkdir -p "$folder"
cd "$folder"

if [[ ! -e ca.key ]]; then
  openssl req -x509 "${key[@]}" -keyout ca.key -out ca.pem -days 3650 -subj "/CN=hl-dagger lab" \
    -addext "basicConstraints=critical,CA:TRUE" -addext "keyUsage=critical,keyCertSign,cRLSign"
fi

openssl req -new "${key[@]}" -keyout "$name.key" -out "$name.csr" -subj "/CN=$name"
openssl x509 -req -in "$name.csr" -CA ca.pem -CAkey ca.key -CAcreateserial -out "$name.pem" \
  -days 800 -extfile <(
    echo "subjectAltName=DNS:$name${address:+,IP:$address}"
    echo "basicConstraints=CA:FALSE"
    echo "extendedKeyUsage=serverAuth,clientAuth"
  )
rm "$name.csr"
