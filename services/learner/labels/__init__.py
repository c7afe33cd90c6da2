"""Labels: which goal should the high level have proposed, where does anybody know?"""
