"""`hld experiment dagger`: do corrections help, how much, and is it the corrections?"""
